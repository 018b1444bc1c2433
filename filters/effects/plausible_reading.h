// SPDX-License-Identifier: Apache-2.0
// Causal plausibility test of a channel's readings: loggers write 9999, 85 or -127 degC for missing values,
// which must not be used for corrections.
#pragma once

#include <algorithm>
#include <cmath>

#include "filters/model_file/model.h"

namespace ifog {

// Rejects readings far outside the fitted range, or that jump out of it as this channel never did. Rejection
// ends after a minute, unless the reading repeats one number.
class PlausibleReading {
 public:
  // True if the reading is plausible. value: NaN if missing (false). dt_s: since the last step.
  [[nodiscard]] bool step(double value, double dt_s, const ChannelRange& range) noexcept {
    away_s_ += dt_s;
    if (!std::isfinite(value)) return false;
    const double span = range.high - range.low;
    const double outside = std::max(value - range.high, range.low - value);
    const bool inside = !(outside > 0.0);
    if (inside) settled_outside_ = false;
    const bool leap = !inside && span > 0.0 && std::isfinite(span) && leaps(value, outside, span);
    if (leap && (value == refused_ || (away_s_ <= kBelievedAfter_s && !settled_outside_))) {
      refused_ = value;
      return false;
    }
    settled_outside_ |= leap;
    if (inside && was_inside_ && away_s_ <= kBelievedAfter_s) learn(std::abs(value - last_));
    was_inside_ = inside;
    away_s_ = 0.0;
    last_ = value;
    seen_ = true;
    return true;
  }

 private:
  static constexpr double kBelievedAfter_s = 60.0;
  static constexpr double kFar = 20.0;  // spans outside
  // For slow channels: the largest change per reading, in spans, after kMoves changes; and the smallest jump,
  // in spans and in units of the largest change.
  static constexpr double kSlow = 0.15;
  static constexpr int kMoves = 8;
  static constexpr double kLeap = 0.2, kLeapOfMoves = 8.0;

  [[nodiscard]] bool leaps(double value, double outside, double span) const noexcept {
    if (outside > kFar * span) return true;
    if (!seen_) return false;
    // Within one span a correction is extrapolated.
    return moves_ >= kMoves && outside > span && largest_ <= kSlow * span &&
           std::abs(value - last_) > std::max(kLeap * span, kLeapOfMoves * largest_);
  }
  void learn(double move) noexcept {
    if (!seen_ || !(move > 0.0)) return;
    largest_ = std::max(largest_, move);
    moves_ = std::min(moves_ + 1, kMoves);
  }

  double last_ = 0.0;
  double largest_ = 0.0;  // largest change per reading
  double away_s_ = 0.0;   // since the last plausible reading
  double refused_ = std::nan("");
  int moves_ = 0;
  bool seen_ = false, was_inside_ = false;
  bool settled_outside_ = false;  // jumps outside have lasted too long to be rejected
};

}  // namespace ifog
