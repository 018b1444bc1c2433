// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/transport.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "drivers/transport/clock.h"

namespace ifog {
namespace {

// Time that open() waits for an answer.
constexpr std::int64_t kOpenLimit_ns = 1'000'000'000;

}  // namespace

OpenError::OpenError(const std::string& device, const std::string& what, int error,
                     const std::string& expected)
    : std::runtime_error(device + ": " + what + ": " + std::generic_category().message(error) +
                         ", expected " + expected),
      reason(error) {}

void Transport::open(std::span<const std::uint8_t> opening) {
  opening_.assign(opening.begin(), opening.end());
  std::string warning;
  try {
    if (!connect(warning, monotonic_ns() + kOpenLimit_ns))
      throw OpenError(name_, "cannot open", ETIMEDOUT, "an answer within a second");
  } catch (const OpenError& error) {
    enter(TransportState::gone, error.reason);
    failed();
    throw;
  }
  notices_.keep_warning(std::move(warning));
  link_.open = link_.once = true;
  link_.since_ns = monotonic_ns();
  enter(TransportState::open, 0);
}

Delivery Transport::read(std::chrono::nanoseconds timeout) noexcept {
  const std::int64_t until = monotonic_ns() + timeout.count();
  if (stopped() || state() == TransportState::ended) return {};
  if (!link_.open && !regain(until)) return {};
  const std::int64_t entered_ns = arrival_clock_ns();
  Delivery delivery = receive(until);
  if (delivery.read_ns == 0) delivery.read_ns = arrival_clock_ns();
  if (!times_are_recorded() && backlog_.read(entered_ns, delivery.read_ns, timeout.count())) {
    if (!delivery.stamped) delivery.arrival_ns = 0;
    if (backlog_.may_be_over() && !more_waits()) backlog_.over();
  }
  if (delivery.empty()) return {};
  delivery.restarted = std::exchange(link_.returning, false);
  if (state() == TransportState::gone) {
    enter(TransportState::open, 0);
    counters_.reopened.add(1);
  }
  counters_.bytes.add(delivery.bytes.size());
  counters_.frames.add(delivery.frames.size());
  return delivery;
}

bool Transport::regain(std::int64_t until_ns) noexcept {
  for (;;) {
    if (waiting_.wait(-1, 0, std::min(link_.attempt_ns, until_ns)) == Wake::stopped) return false;
    if (until_ns < link_.attempt_ns) return false;
    try {
      std::string warning;
      if (!connect(warning, until_ns)) return false;
      notices_.keep_warning(std::move(warning));
    } catch (const std::exception& error) {
      const auto* refused = dynamic_cast<const OpenError*>(&error);
      enter(TransportState::gone, refused != nullptr ? refused->reason : ENOMEM);
      failed();
      continue;
    }
    link_.open = true;
    link_.since_ns = monotonic_ns();
    backlog_ = {};  // no backlog while the device is away
    enter(TransportState::open, 0);
    if (std::exchange(link_.once, true)) {
      link_.returning = true;
      counters_.reopened.add(1);
    }
    return true;
  }
}

void Transport::lost(int reason) noexcept {
  link_.open = false;
  enter(TransportState::gone, reason);
  const std::int64_t now = monotonic_ns();
  // A device that opens and disappears at once (a busy server, a faulty line) is retried after a pause.
  if (now - link_.since_ns <= kLongestPause_ns) return failed();
  link_.attempt_ns = now;
  link_.pause_ns = kFirstPause_ns;
}

void Transport::failed() noexcept {
  link_.attempt_ns = monotonic_ns() + link_.pause_ns;
  link_.pause_ns = std::min(2 * link_.pause_ns, kLongestPause_ns);
}

void Transport::left() noexcept {
  link_.returning = true;
  enter(TransportState::gone, 0);
}

void Transport::enter(TransportState state, int reason) noexcept {
  reason_.store(reason, std::memory_order_relaxed);
  state_.store(state, std::memory_order_release);
}

void Transport::report(const char* what, std::uint64_t line, std::string_view text) noexcept {
  counters_.malformed.add(1);
  for (KindOfFault& kind : faults_.kinds) {
    if (kind.fault.what == what) return;
    if (kind.fault.what != nullptr) continue;
    kind.fault = {what, line, {kind.text.data(), text.copy(kind.text.data(), kind.text.size())}};
    faults_.latest.store(&kind.fault, std::memory_order_release);
    return;
  }
}

TransportCounters Transport::counters() const {
  return {counters_.bytes.value(),        counters_.frames.value(),   counters_.kernel_drops.value(),
          counters_.error_frames.value(), counters_.reopened.value(), counters_.malformed.value()};
}

TransportFault Transport::fault() const {
  const TransportFault* const latest = faults_.latest.load(std::memory_order_acquire);
  return latest == nullptr ? TransportFault{} : *latest;
}

}  // namespace ifog
