// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/daemon/faults/parts.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <thread>
#include <utility>

#include "drivers/transport/clock.h"

namespace ifog {

using namespace std::chrono_literals;

FaultyTransport::FaultyTransport(const Wire& wire, std::vector<std::size_t> cuts, unsigned seed,
                                 bool holds_back)
    : Transport("faulty"), wire_(wire), cuts_(std::move(cuts)), random_(seed), holds_back_(holds_back) {}

bool FaultyTransport::connect(std::string&, std::int64_t) {
  if (refusals_ == 0) return true;
  --refusals_;
  throw OpenError("faulty", "cannot open", ENODEV, "a device");
}

void FaultyTransport::count_losses() noexcept { counters_.kernel_drops.add(std::exchange(untold_, 0)); }

void FaultyTransport::cut() noexcept {
  ++next_cut_;
  if (below(2) == 0) {
    left();
    return;
  }
  count_losses();
  refusals_ = below(2);
  lost(wire_.can() ? ENETDOWN : ENODEV);
}

Delivery FaultyTransport::receive(std::int64_t) noexcept {
  Delivery out;
  if (at_ == wire_.size()) {
    end(0);
    return out;
  }
  if (next_cut_ < cuts_.size() && at_ == cuts_[next_cut_]) {
    cut();
    return out;
  }
  if (below(20) == 0) {
    const std::uint64_t drops = below(5);
    dropped_ += drops;
    if (below(2) == 0)
      counters_.kernel_drops.add(drops);
    else
      untold_ += drops;
  }
  const std::size_t until = next_cut_ < cuts_.size() ? cuts_[next_cut_] : wire_.size();
  const std::size_t n = std::min<std::size_t>(until - at_, 1 + below(wire_.can() ? 8 : 300));
  if (wire_.can())
    out.frames = std::span(wire_.frames).subspan(at_, n);
  else
    out.bytes = std::span(wire_.bytes).subspan(at_, n);
  at_ += n;
  out.arrival_ns = wire_.arrival_ns(at_);
  given_.store(at_, std::memory_order_release);
  return out;
}

FloodedBus::FloodedBus(unsigned seed, std::atomic<std::uint64_t>& dropped)
    : Transport("flooded"), random_(seed), dropped_(dropped), frames_(64) {}

Delivery FloodedBus::receive(std::int64_t) noexcept {
  // Without a pause it would take a processor of the machine that other tests run on, too.
  std::this_thread::sleep_for(100us);
  for (ifog_can_frame& frame : frames_) {
    const auto fate = random_() % 8;
    frame = {};
    frame.id = fate == 0 ? 273 : 272;
    frame.length = static_cast<std::uint8_t>(fate == 1 ? 3 : 8);
    frame.arrival_ns = arrival_clock_ns();
    auto value = static_cast<float>(kLeast_degC) + static_cast<float>(random_() % 11);
    if (fate == 2) value = std::numeric_limits<float>::quiet_NaN();
    if (fate == 3) value = 1e30F;
    if (fate == 4) value = 90.0F;  // within the DBC file's range, not the user's
    std::memcpy(frame.data, &value, sizeof value);
  }
  const std::uint64_t drops = random_() % 3;
  dropped_ += drops;
  counters_.kernel_drops.add(drops);
  Delivery out;
  out.frames = frames_;
  return out;
}

bool FaultyPublisher::publish(const char*, std::span<const std::uint8_t> message) noexcept {
  const int fate = std::uniform_int_distribution<int>(0, 49)(random_);
  if (slow_ && fate < 5) std::this_thread::sleep_for(200us);
  const std::lock_guard lock(mutex_);
  readable_ = last_.decode(message.data(), 0, static_cast<int>(message.size())) > 0 && readable_;
  if (last_.arrival_ns != 0) {
    const double shift_s =
        static_cast<double>(last_.utime) * 1e-6 - static_cast<double>(last_.arrival_ns) * 1e-9;
    shifts_min_.insert(std::llround(shift_s / 60.0));
  }
  if (fate == 49) return false;
  ++taken_;
  return true;
}

double FaultyPublisher::angle() const {
  const std::lock_guard lock(mutex_);
  return last_.axes > 0 ? last_.angle[0] : 0.0;
}

std::uint64_t FaultyPublisher::taken() const {
  const std::lock_guard lock(mutex_);
  return taken_;
}

bool FaultyPublisher::all_readable() const {
  const std::lock_guard lock(mutex_);
  return readable_;
}

std::set<std::int64_t> FaultyPublisher::label_shifts_min() const {
  const std::lock_guard lock(mutex_);
  return shifts_min_;
}

}  // namespace ifog
