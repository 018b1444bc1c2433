// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/transport.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "drivers/transport/clock.h"

namespace ifog {
namespace {

// How long open() waits for the other end's answer.
constexpr std::int64_t kOpenLimit_ns = 1'000'000'000;

}  // namespace

OpenError::OpenError(const std::string& device, const std::string& what, int error,
                     const std::string& expected)
    : std::runtime_error(device + ": " + what + ": " + std::generic_category().message(error) +
                         ", expected " + expected),
      reason(error) {}

Transport::Transport(std::string name)
    : name_(std::move(name)), stop_event_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (stop_event_ < 0)
    throw std::runtime_error(name_ + ": cannot make an eventfd: " + std::generic_category().message(errno));
}

Transport::~Transport() { close(stop_event_); }

void Transport::stop() noexcept {
  const int before = errno;  // a signal handler leaves errno as it was
  stopped_.store(true);
  // Never read again, so the event stays set and every later wait returns at once.
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(stop_event_, &one, sizeof one);
  ReadAlarm::ring(alarm_.load());
  errno = before;
}

void Transport::open(std::span<const std::uint8_t> opening) {
  opening_.assign(opening.begin(), opening.end());
  std::string warning;
  try {
    if (!connect(warning, monotonic_ns() + kOpenLimit_ns))
      throw OpenError(name_, "cannot open", ETIMEDOUT, "an answer within a second");
  } catch (const OpenError& error) {
    enter(TransportState::gone, error.reason);
    backoff_.failed(monotonic_ns());
    throw;
  }
  keep_warning(std::move(warning));
  connected_ = once_ = true;
  connected_ns_ = monotonic_ns();
  enter(TransportState::open, 0);
}

void Transport::keep_warning(std::string&& warning) {
  const std::lock_guard lock(warning_mutex_);
  new_warning_ = new_warning_ || (!warning.empty() && warning != warning_);
  warning_ = std::move(warning);
}

std::string Transport::take_warning() {
  const std::lock_guard lock(warning_mutex_);
  return std::exchange(new_warning_, false) ? warning_ : std::string();
}

void Transport::keep_answers(const std::string& answers) {
  const std::lock_guard lock(warning_mutex_);
  answers_ = answers;
}

std::string Transport::take_answers() {
  const std::lock_guard lock(warning_mutex_);
  return std::exchange(answers_, {});
}

Delivery Transport::read(std::chrono::nanoseconds timeout) noexcept {
  const std::int64_t entered_ns = arrival_clock_ns();
  const std::int64_t until = monotonic_ns() + timeout.count();
  if (stopped() || state() == TransportState::ended) return {};
  if (!connected_ && !regain(until)) return {};
  Delivery delivery = receive(until);
  if (delivery.read_ns == 0) delivery.read_ns = arrival_clock_ns();
  if (!times_are_recorded() && backlog_.read(entered_ns, delivery.read_ns, timeout.count())) {
    if (!delivery.stamped) delivery.arrival_ns = 0;
    if (backlog_.may_be_over() && !more_waits()) backlog_.over();
  }
  if (delivery.empty()) return {};
  delivery.restarted = std::exchange(returning_, false);
  if (state() == TransportState::gone) {
    enter(TransportState::open, 0);
    reopened_.add(1);
  }
  bytes_.add(delivery.bytes.size());
  frames_.add(delivery.frames.size());
  return delivery;
}

bool Transport::regain(std::int64_t until_ns) noexcept {
  for (;;) {
    const std::int64_t attempt = std::min(backoff_.next_ns(), until_ns);
    short happened = 0;
    if (wait(-1, 0, attempt, happened) == Wake::stopped) return false;
    if (attempt < backoff_.next_ns()) return false;
    ReadAlarm::of_this_thread().off();
    try {
      std::string warning;
      if (!connect(warning, until_ns)) return false;
      keep_warning(std::move(warning));
    } catch (const std::exception& error) {
      const auto* refused = dynamic_cast<const OpenError*>(&error);
      enter(TransportState::gone, refused != nullptr ? refused->reason : ENOMEM);
      backoff_.failed(monotonic_ns());
      continue;
    }
    connected_ = true;
    connected_ns_ = monotonic_ns();
    enter(TransportState::open, 0);
    if (std::exchange(once_, true)) {
      returning_ = true;
      reopened_.add(1);
    }
    return true;
  }
}

void Transport::lost(int reason) noexcept {
  connected_ = false;
  enter(TransportState::gone, reason);
  const std::int64_t now = monotonic_ns();
  // One that opens and at once goes away again (a server that is taken, a line that only errs) is not tried
  // without a pause.
  if (now - connected_ns_ > Backoff::kLongest_ns)
    backoff_.restart(now);
  else
    backoff_.failed(now);
}

void Transport::left() noexcept {
  returning_ = true;
  enter(TransportState::gone, 0);
}

Transport::Wake Transport::wait(int fd, short events, std::int64_t until_ns, short& happened) noexcept {
  happened = 0;
  for (;;) {
    std::array<pollfd, 2> fds{{{stop_event_, POLLIN, 0}, {fd, events, 0}}};
    const std::int64_t left = std::max<std::int64_t>(0, until_ns - monotonic_ns());
    const timespec span{left / 1'000'000'000, left % 1'000'000'000};
    const int n = ppoll(fds.data(), fd < 0 ? 1 : 2, &span, nullptr);
    if (stopped() || (n > 0 && fds[0].revents != 0)) return Wake::stopped;
    if (n == 0) return Wake::timeout;
    if (n > 0) {
      happened = fds[1].revents;
      return Wake::ready;
    }
    // Interrupted by a signal: wait for the rest.
  }
}

const short Transport::kReadable = POLLIN;

Transport::Entry Transport::enter_call(std::int64_t until_ns) noexcept {
  ReadAlarm& alarm = ReadAlarm::of_this_thread();
  if (alarm.number() != alarm_.load(std::memory_order_relaxed)) alarm_.store(alarm.number());
  do {
    if (!alarm.is_set(until_ns) && (until_ns <= monotonic_ns() || !alarm.set(until_ns)))
      return Entry::poll_first;
    // After the alarm is set: what stop() rings from now on is not set again.
    if (stopped_.load()) return Entry::stopped;
  } while (!alarm.enter());
  return Entry::call;
}

short Transport::happened_to(int fd) noexcept {
  pollfd asked{fd, POLLIN, 0};
  return ::poll(&asked, 1, 0) > 0 ? asked.revents : short{0};
}

bool Transport::let_block(int fd) noexcept {
  const int flags = fcntl(fd, F_GETFL);
  return flags >= 0 && fcntl(fd, F_SETFL, flags & ~O_NONBLOCK) == 0;
}

void Transport::enter(TransportState state, int reason) noexcept {
  reason_.store(reason, std::memory_order_relaxed);
  state_.store(state, std::memory_order_release);
}

void Transport::report(const char* what, std::uint64_t line, std::string_view text) noexcept {
  malformed_.add(1);
  for (KindOfFault& kind : kinds_) {
    if (kind.fault.what == what) return;
    if (kind.fault.what != nullptr) continue;
    kind.fault = {what, line, {kind.text.data(), text.copy(kind.text.data(), kind.text.size())}};
    fault_.store(&kind.fault, std::memory_order_release);
    return;
  }
}

TransportCounters Transport::counters() const {
  return {bytes_.value(),        frames_.value(),   kernel_drops_.value(),
          error_frames_.value(), reopened_.value(), malformed_.value()};
}

TransportFault Transport::fault() const {
  const TransportFault* const latest = fault_.load(std::memory_order_acquire);
  return latest == nullptr ? TransportFault{} : *latest;
}

}  // namespace ifog
