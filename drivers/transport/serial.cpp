// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/serial.h"
#include "drivers/transport/clock.h"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <stdexcept>
#include <utility>

namespace ifog {
namespace {

constexpr std::int64_t kSendLimit_ns = 1'000'000'000;
// Once the device is gone its driver tells no more, so what the line has counted by then is as old as this at
// most.
constexpr std::int64_t kErrorPeriod_ns = 100'000'000;

// A read waits for the first byte and brings what is there. False: it cannot be had, the line is to be
// polled.
bool wait_for_bytes(int fd) {
  termios line{};
  if (tcgetattr(fd, &line) != 0) return false;
  line.c_cc[VMIN] = 1;
  line.c_cc[VTIME] = 0;
  return tcsetattr(fd, TCSANOW, &line) == 0;
}

class SerialTransport final : public Transport {
 public:
  SerialTransport(const SerialSettings& settings, SerialOpener open_port)
      : Transport(settings.device), settings_(settings), open_port_(std::move(open_port)) {}

 private:
  bool connect(std::string& warning, std::int64_t until_ns) override;
  Delivery receive(std::int64_t until_ns) noexcept override;
  [[nodiscard]] bool more_waits() noexcept override {
    pollfd port{port_ ? port_->fd() : -1, POLLIN, 0};
    return ::poll(&port, 1, 0) > 0;
  }
  void send_opening();
  void count_losses() noexcept override;

  SerialSettings settings_;
  SerialOpener open_port_;
  std::unique_ptr<SerialPort> port_;
  LineErrors errors_;
  bool errors_known_ = false, blocks_ = false;
  std::int64_t next_errors_ns_ = 0;
  std::array<std::uint8_t, 16384> buffer_{};
};

bool SerialTransport::connect(std::string& warning, std::int64_t /*until_ns*/) {
  port_.reset();
  port_ = open_port_(settings_, warning);
  send_opening();
  blocks_ = wait_for_bytes(port_->fd()) && let_block(port_->fd());
  errors_known_ = port_->errors(errors_);
  next_errors_ns_ = arrival_clock_ns() + kErrorPeriod_ns;
  return true;
}

void SerialTransport::send_opening() {
  std::span<const std::uint8_t> rest = opening();
  const std::int64_t limit = monotonic_ns() + kSendLimit_ns;
  while (!rest.empty()) {
    const ssize_t n = write(port_->fd(), rest.data(), rest.size());
    if (n > 0) {
      rest = rest.subspan(static_cast<std::size_t>(n));
      continue;
    }
    int error = n < 0 ? errno : EIO;
    if (error == EINTR) continue;
    short happened = 0;
    if (error == EAGAIN) {
      if (wait(port_->fd(), POLLOUT, limit, happened) == Wake::ready) continue;
      error = ETIMEDOUT;
    }
    port_.reset();
    throw OpenError(name(), "cannot send the opening bytes", error, "a device that takes them");
  }
}

Delivery SerialTransport::receive(std::int64_t until_ns) noexcept {
  const Received got = receive_by(port_->fd(), blocks_, until_ns,
                                  [&](bool) { return ::read(port_->fd(), buffer_.data(), buffer_.size()); });
  Delivery delivery;
  delivery.read_ns = arrival_clock_ns();
  if (delivery.read_ns >= next_errors_ns_) {
    next_errors_ns_ = delivery.read_ns + kErrorPeriod_ns;
    count_losses();
  }
  if (got.wake != Wake::ready) return {};
  if (got.n > 0) {
    delivery.arrival_ns = delivery.read_ns;
    delivery.bytes = std::span<const std::uint8_t>(buffer_).first(static_cast<std::size_t>(got.n));
    return delivery;
  }
  // Nothing to read is no fault of the device (another process may have taken it), a hang-up is.
  const int error = got.error;
  const bool hung_up = (got.happened & (POLLHUP | POLLERR | POLLNVAL)) != 0;
  if (error == EINTR || (!hung_up && (error == 0 || error == EAGAIN))) {
    blocks_ = false;  // it does not wait for bytes, or no longer does: another process has set it otherwise
    return {};
  }
  count_losses();
  // Closed at once: while it is held open the kernel gives a returning USB adapter another name.
  port_.reset();
  lost(error == 0 || error == EAGAIN ? ENODEV : error);
  return {};
}

void SerialTransport::count_losses() noexcept {
  LineErrors now;
  if (!errors_known_ || !port_->errors(now)) return;
  kernel_drops_.add(now.lost - errors_.lost);  // modulo 2^32
  error_frames_.add(now.damaged - errors_.damaged);
  errors_ = now;
}

}  // namespace

std::unique_ptr<Transport> make_serial_transport(const SerialSettings& settings, SerialOpener open_port) {
  const auto refuse = [&](const std::string& what) {
    throw std::runtime_error((settings.device.empty() ? "serial transport" : settings.device) + ": " + what);
  };
  if (settings.device.empty()) refuse("no device, expected a serial device such as /dev/ttyUSB0");
  if (settings.baud < 50 || settings.baud > 20'000'000)
    refuse("baud is " + std::to_string(settings.baud) + ", expected 50 to 20000000");
  if (settings.data_bits < 5 || settings.data_bits > 8)
    refuse("data_bits is " + std::to_string(settings.data_bits) + ", expected 5 to 8");
  if (settings.stop_bits < 1 || settings.stop_bits > 2)
    refuse("stop_bits is " + std::to_string(settings.stop_bits) + ", expected 1 or 2");
  return std::make_unique<SerialTransport>(settings, std::move(open_port));
}

}  // namespace ifog
