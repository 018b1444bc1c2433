// SPDX-License-Identifier: Apache-2.0
#include "drivers/ifog/quoted.h"
#include "drivers/transport/clock.h"
#include "drivers/transport/serial/serial_port.h"
#include "drivers/transport/serial/set_up_dialogue.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <utility>

namespace ifog {
namespace {

constexpr std::int64_t kSendLimit_ns = 1'000'000'000;
// Largest age of the line's error counters when the device disappears, since they cannot be read then.
constexpr std::int64_t kErrorPeriod_ns = 100'000'000;
constexpr std::int64_t kAnswerLimit_ns = 500'000'000;
// The slowest rate of a KVH 1750 is 1 Hz.
constexpr std::int64_t kSilentLimit_ns = 1'200'000'000;

class SerialTransport final : public Transport {
 public:
  SerialTransport(const SerialSettings& settings, SerialOpener open_port)
      : Transport(settings.device), settings_(settings), open_port_(std::move(open_port)) {}

 private:
  bool connect(std::string& warning, std::int64_t until_ns) override;
  Delivery receive(std::int64_t until_ns) noexcept override;
  [[nodiscard]] bool more_waits() noexcept override { return waiting_.is_readable(port_ ? port_->fd() : -1); }
  void send(std::span<const std::uint8_t> rest);
  bool set_up(std::int64_t until_ns);
  [[noreturn]] void refuse_answer();
  void count_losses() noexcept override;

  SerialSettings settings_;
  SerialOpener open_port_;
  std::unique_ptr<SerialPort> port_;
  std::optional<SetUpDialogue> dialogue_;  // while it runs
  std::int64_t answer_by_ns_ = 0;          // CLOCK_MONOTONIC; 0: the line is not sent yet
  std::int64_t received_ns_ = 0;           // last byte, CLOCK_MONOTONIC
  bool tried_ = false;
  LineErrors errors_;
  bool errors_known_ = false;
  std::int64_t next_errors_ns_ = 0;
  std::array<std::uint8_t, 16384> buffer_{};
};

bool SerialTransport::connect(std::string& warning, std::int64_t until_ns) {
  if (!dialogue_) {
    port_.reset();
    port_ = open_port_(settings_, warning);
    dialogue_.emplace(settings_.set_up);
    answer_by_ns_ = 0;
  }
  if (!set_up(until_ns)) {
    tried_ = true;
    return false;
  }
  dialogue_.reset();
  send(opening());
  received_ns_ = monotonic_ns();
  errors_known_ = port_->errors(errors_);
  next_errors_ns_ = arrival_clock_ns() + kErrorPeriod_ns;
  return true;
}

// One line at a time. False: not finished, or stopped; the next call continues.
bool SerialTransport::set_up(std::int64_t until_ns) {
  while (!dialogue_->done()) {
    if (answer_by_ns_ == 0) {
      const std::string line = dialogue_->line() + "\r\n";
      send({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()});
      answer_by_ns_ = monotonic_ns() + kAnswerLimit_ns;
    }
    const Wake wake = waiting_.wait(port_->fd(), POLLIN, std::min(until_ns, answer_by_ns_));
    if (wake == Wake::stopped) return false;
    const ssize_t n = wake == Wake::ready ? ::read(port_->fd(), buffer_.data(), buffer_.size()) : 0;
    const std::span<const std::uint8_t> bytes(buffer_);
    if (n > 0 && dialogue_->take(bytes.first(static_cast<std::size_t>(n)))) {
      answer_by_ns_ = 0;
      continue;
    }
    if (!dialogue_->refusal().empty() || monotonic_ns() >= answer_by_ns_ || (wake == Wake::ready && n <= 0))
      refuse_answer();
    if (monotonic_ns() >= until_ns) return false;
  }
  tried_ = true;
  if (!dialogue_->answers().empty())
    notices().keep_answers(name() + ": set up, it answered " + dialogue_->answers());
  return true;
}

void SerialTransport::refuse_answer() {
  const bool differs = !dialogue_->refusal().empty();
  const OpenError error(
      name(),
      differs ? "answered " + in_quotes(dialogue_->refusal()) + " to " + in_quotes(dialogue_->line())
              : "no answer to " + in_quotes(dialogue_->line()),
      differs ? EPROTO : ETIMEDOUT, in_quotes(dialogue_->expected()));
  port_.reset();
  dialogue_.reset();
  // Exceptions of open() are logged by its caller.
  if (std::exchange(tried_, true)) notices().keep_warning(error.what());
  throw error;
}

void SerialTransport::send(std::span<const std::uint8_t> rest) {
  const std::int64_t limit = monotonic_ns() + kSendLimit_ns;
  while (!rest.empty()) {
    const ssize_t n = write(port_->fd(), rest.data(), rest.size());
    if (n > 0) {
      rest = rest.subspan(static_cast<std::size_t>(n));
      continue;
    }
    int error = n < 0 ? errno : EIO;
    if (error == EINTR) continue;
    if (error == EAGAIN) {
      if (waiting_.wait(port_->fd(), POLLOUT, limit) == Wake::ready) continue;
      error = ETIMEDOUT;
    }
    port_.reset();
    dialogue_.reset();
    throw OpenError(name(), "cannot send the opening bytes", error, "a device that takes them");
  }
}

Delivery SerialTransport::receive(std::int64_t until_ns) noexcept {
  short happened = 0;
  const Wake wake = waiting_.wait(port_->fd(), POLLIN, until_ns, &happened);
  const ssize_t n = wake == Wake::ready ? ::read(port_->fd(), buffer_.data(), buffer_.size()) : 0;
  const int error = n < 0 ? errno : 0;
  Delivery delivery;
  delivery.read_ns = arrival_clock_ns();
  if (delivery.read_ns >= next_errors_ns_) {
    next_errors_ns_ = delivery.read_ns + kErrorPeriod_ns;
    count_losses();
  }
  if (!settings_.set_up.empty()) {
    const std::int64_t now_ns = monotonic_ns();
    if (n > 0) received_ns_ = now_ns;
    if (now_ns - received_ns_ > kSilentLimit_ns) {
      port_.reset();
      lost(ETIMEDOUT);
      return {};
    }
  }
  if (wake != Wake::ready) return {};
  if (n > 0) {
    delivery.arrival_ns = delivery.read_ns;
    delivery.bytes = std::span<const std::uint8_t>(buffer_).first(static_cast<std::size_t>(n));
    return delivery;
  }
  // No data is no fault (another process may have read them), a hang-up is.
  const bool hung_up = (happened & (POLLHUP | POLLERR | POLLNVAL)) != 0;
  if (error == EINTR || (!hung_up && (error == 0 || error == EAGAIN))) return {};
  count_losses();
  // Closed at once, since the kernel would give a returning USB adapter another name.
  port_.reset();
  lost(error == 0 || error == EAGAIN ? ENODEV : error);
  return {};
}

void SerialTransport::count_losses() noexcept {
  LineErrors now;
  if (!errors_known_ || !port_->errors(now)) return;
  counters_.kernel_drops.add(now.lost - errors_.lost);  // modulo 2^32
  counters_.error_frames.add(now.damaged - errors_.damaged);
  errors_ = now;
}

}  // namespace

std::unique_ptr<Transport> make_serial_transport(const SerialSettings& settings, SerialOpener open_port) {
  return std::make_unique<SerialTransport>(settings, std::move(open_port));
}

}  // namespace ifog
