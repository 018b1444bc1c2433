// SPDX-License-Identifier: Apache-2.0
#include "drivers/row_times/scattered_stamps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace ifog {
namespace {

constexpr std::size_t kNext = 7;       // stamps whose median confirms a gap
constexpr std::size_t kReturn = 1024;  // stamps in which a delay returns: 10 s at 100 Hz, of a stalled host
constexpr std::size_t kSettle = 128;   // stamps that give the initial phase
constexpr double kHalf = 0.5;          // of a period
// Second-order tracker, critically damped. It settles within 100 samples; stamps off by up to half a period
// move it by 1/25 period.
constexpr double kPhaseGain = 1.0 / 32.0, kRateGain = kPhaseGain * kPhaseGain / 4.0;
// After a silence of this many periods the device may have restarted with any phase.
constexpr std::size_t kSilence = 8;
constexpr double kMostLost = 1e15;

// Tracking clock: lateness of a stamp in periods, given the sample numbers so far.
class Clock {
 public:
  explicit Clock(double period_s) : period_s_(period_s) {}

  // Initial phase from the median lateness. times: the first stamp, or the first one after a silence, and
  // those that follow it.
  void begin(std::span<const double> times) {
    Clock trial(period_s_);
    std::array<double, kSettle> late{};
    std::size_t count = 1;
    for (double numbers = 0.0; count < std::min(kSettle, times.size()); ++count) {
      const std::size_t lost = trial.take(times[count - 1], times.subspan(count));
      if (lost > kSilence) break;
      numbers += 1.0 + static_cast<double>(lost);
      late[count] = (times[count] - times[0]) / period_s_ - numbers;
    }
    late_ = -middle_of(std::span(late).first(count));
    late_ -= std::round(late_);
  }
  // Returns the number of samples lost before the next stamp. times: that stamp and those that follow it.
  std::size_t take(double last_s, std::span<const double> times) {
    late_ += (times[0] - last_s) / period_s_ - 1.0 - rate_;
    double lost = 0.0;
    if (late_ > kHalf)
      lost = std::max(0.0, std::round(std::min({late_, lateness_of_next(times), kMostLost})));
    late_ -= lost;
    if (late_ > 4.0 * kHalf)
      return static_cast<std::size_t>(lost);  // a delay that returns says nothing of the clock
    const double off = std::clamp(late_, -kHalf, kHalf);
    late_ -= kPhaseGain * off;
    rate_ += kRateGain * off;
    return static_cast<std::size_t>(lost);
  }

 private:
  // Least median lateness of the next stamps and of longer runs behind them: after a delay that returns it is that
  // before the delay.
  [[nodiscard]] double lateness_of_next(std::span<const double> times) const {
    std::array<double, kSettle> late{};
    double least = kMostLost;
    for (std::size_t at = 0, run = kNext; at < times.size() && at < kReturn && least > kHalf;
         at += run, run = kSettle) {
      const std::size_t count = std::min(run, times.size() - at);
      if (at > 0 && count < kNext) break;
      for (std::size_t k = 0; k < count; ++k)
        late[k] = late_ + (times[at + k] - times[0]) / period_s_ - static_cast<double>(at + k);
      least = std::min(least, middle_of(std::span(late).first(count)));
    }
    return least;
  }
  // An element, not the mean of two, which may be on either side of a gap.
  static double middle_of(std::span<double> values) {
    const auto middle = values.begin() + (std::ssize(values) - 1) / 2;
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

  double period_s_;
  double late_ = 0.0, rate_ = 0.0;  // of the last stamp used; relative error of the period
};

}  // namespace

void holes_of_scattered(std::span<const double> time_s, double period_s,
                        const std::function<void(std::size_t i, std::size_t lost, double step_s)>& found) {
  const std::size_t samples = time_s.size();
  Clock clock(period_s);
  clock.begin(time_s);
  for (std::size_t i = 0; i + 1 < samples; ++i) {
    const std::span<const double> next = time_s.subspan(i + 1);
    const std::size_t lost = clock.take(time_s[i], next);
    if (lost == 0) continue;
    found(i, lost, next[0] - time_s[i]);
    if (lost > kSilence) clock.begin(next);
  }
}

}  // namespace ifog
