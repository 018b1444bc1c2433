// SPDX-License-Identifier: Apache-2.0
// Reading of a channel delayed by a fixed time, for channels that are stamped too early, e.g. because the
// logger buffers the gyro's data. A lag would not do: a jump must remain a jump.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace ifog {

// Linear interpolation between stored readings, which are 1/500 of the delay apart. Until one is old enough
// the first is used. Allocates only in the constructor.
class DelayedReading {
 public:
  DelayedReading() = default;
  explicit DelayedReading(double delay_s) : delay_s_(delay_s), kept_(delay_s > 0.0 ? kPieces + 4 : 0) {}

  [[nodiscard]] bool delays() const noexcept { return delay_s_ > 0.0; }
  [[nodiscard]] bool begun() const noexcept { return count_ > 0; }

  // dt_s: since the last step.
  double step(double value, double dt_s) noexcept {
    now_s_ = begun() ? now_s_ + dt_s : 0.0;
    latest_ = value;
    if (!begun() || now_s_ - at(count_ - 1).time_s >= delay_s_ / static_cast<double>(kPieces)) {
      at(count_) = {now_s_, value};
      ++count_;
    }
    const double wanted_s = now_s_ - delay_s_;
    while (count_ > 1 && at(1).time_s <= wanted_s) {
      first_ = (first_ + 1) % kept_.size();
      --count_;
    }
    const Reading& before = at(0);
    const Reading after = count_ > 1 ? at(1) : Reading{now_s_, value};
    const double between_s = after.time_s - before.time_s;
    if (!(wanted_s > before.time_s) || !(between_s > 0.0)) return before.value;
    return before.value + (after.value - before.value) * (wanted_s - before.time_s) / between_s;
  }
  // A step without a new reading; repeats the last one.
  double hold(double dt_s) noexcept { return step(latest_, dt_s); }

  // Continues another compensator's reading if the delay is equal.
  void take_over(const DelayedReading& previous) noexcept {
    if (previous.delay_s_ != delay_s_) return;
    std::copy(previous.kept_.begin(), previous.kept_.end(), kept_.begin());
    first_ = previous.first_;
    count_ = previous.count_;
    now_s_ = previous.now_s_;
    latest_ = previous.latest_;
  }

 private:
  struct Reading {
    double time_s = 0.0, value = 0.0;
  };
  static constexpr std::size_t kPieces = 500;

  // In order of time.
  [[nodiscard]] Reading& at(std::size_t i) noexcept { return kept_[(first_ + i) % kept_.size()]; }

  double delay_s_ = 0.0;
  std::vector<Reading> kept_;
  std::size_t first_ = 0, count_ = 0;
  double now_s_ = 0.0, latest_ = 0.0;
};

}  // namespace ifog
