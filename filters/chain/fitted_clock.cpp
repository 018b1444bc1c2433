// SPDX-License-Identifier: Apache-2.0
#include "filters/chain/fitted_clock.h"

#include <algorithm>
#include <cmath>

#include "drivers/system/nanoseconds.h"

namespace ifog {
namespace {

// A late arrival is limited to this many mean deviations, as it says little about the device's clock.
constexpr double kLatenessLimit = 4.0;
constexpr double kShortest = 0.5;  // shortest true period / nominal period
constexpr double kTells_ns = 1e9;  // shortest line for a period estimate
constexpr double kMost_ns = 9e18;
constexpr double kPrompt_s = 0.05;  // scheduling and delay of an adapter

}  // namespace

FittedClock::FittedClock(double nominal_period_s, int memory) noexcept
    : nominal_ns_(nominal_period_s * 1e9),
      period_ns_(nominal_ns_),
      spread_ns_(nominal_ns_),
      memory_(memory) {}

double FittedClock::lateness_s(double periods, std::int64_t arrival_ns) const noexcept {
  if (fitted_ == 0 || arrival_ns <= 0) return 0.0;
  return (static_cast<double>(ns_between(origin_ns_, arrival_ns)) - time_ns_ - period_ns_ * periods) * 1e-9;
}

// By samples that arrive at more than twice the nominal rate, which no device has.
bool FittedClock::overtaken(std::int64_t arrival_ns) const noexcept {
  const auto elapsed_ns = static_cast<double>(ns_between(origin_ns_, arrival_ns));
  return !settled() && elapsed_ns >= 0.0 && counted_ns_ - elapsed_ns > kPrompt_s * 1e9 &&
         elapsed_ns < kShortest * counted_ns_;
}

std::int64_t FittedClock::advance(double periods, std::int64_t arrival_ns) noexcept {
  counted_ns_ += nominal_ns_ * periods;
  if (fitted_ > 0 && arrival_ns > 0 && overtaken(arrival_ns)) restart();
  const double predicted = time_ns_ + period_ns_ * periods;
  if (arrival_ns <= 0) {
    time_ns_ = predicted;
  } else if (fitted_ == 0) {
    origin_ns_ = arrival_ns;
    time_ns_ = counted_ns_ = 0.0;
    spread_ns_ = std::max(spread_ns_, nominal_ns_);
    fitted_ = 1;
  } else {
    const double residual = static_cast<double>(ns_between(origin_ns_, arrival_ns)) - predicted;
    const double limit = kLatenessLimit * spread_ns_;
    const double pull = std::clamp(residual, -limit, limit);
    fitted_ = std::min(fitted_ + 1, memory_);
    const double n = static_cast<double>(fitted_ - 1);
    const double g = 2.0 * (2.0 * n + 1.0) / ((n + 1.0) * (n + 2.0));
    const double h = 6.0 / ((n + 1.0) * (n + 2.0));
    time_ns_ = predicted + g * pull;
    // The first samples, or a delivery of many at once, give no better period than the nominal one.
    if (n >= 8.0 && counted_ns_ >= kTells_ns)
      period_ns_ = std::clamp(period_ns_ + h * pull, kShortest * nominal_ns_, nominal_ns_ / kShortest);
    spread_ns_ += (std::abs(pull) - spread_ns_) * g;
    // Lower limit, so that a small shift of the arrival times can be followed.
    spread_ns_ = std::max(spread_ns_, 1e-3 * nominal_ns_);
  }
  return ns_after(origin_ns_, std::llround(std::clamp(time_ns_, -kMost_ns, kMost_ns)));
}

}  // namespace ifog
