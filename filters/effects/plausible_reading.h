// SPDX-License-Identifier: Apache-2.0
// Whether what a channel says now may be the channel, as far as can be known without what comes after: a
// logger writes 9999, 85 or -127 degC where it has no value, and a correction by that is worse than none.
#pragma once

#include <algorithm>
#include <cmath>

#include "filters/model_file/model.h"

namespace ifog {

// Judges one channel's readings. One is refused that is outside the range of the fit by far more than a channel goes
// there, or that leaps there as this channel never did; for a minute, and for as long as it is one number
// again and again.
class PlausibleReading {
 public:
  // value: NaN where there is none, which is no reading. dt_s: since the step before.
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
  // For a channel that is slow: the most it moves in a reading, in spans, as many moves have shown; and the
  // least leap, in spans and in the largest of those moves.
  static constexpr double kSlow = 0.15;
  static constexpr int kMoves = 8;
  static constexpr double kLeap = 0.2, kLeapOfMoves = 8.0;

  [[nodiscard]] bool leaps(double value, double outside, double span) const noexcept {
    if (outside > kFar * span) return true;
    if (!seen_) return false;
    // Within a span of it a correction is extrapolated.
    return moves_ >= kMoves && outside > span && largest_ <= kSlow * span &&
           std::abs(value - last_) > std::max(kLeap * span, kLeapOfMoves * largest_);
  }
  void learn(double move) noexcept {
    if (!seen_ || !(move > 0.0)) return;
    largest_ = std::max(largest_, move);
    moves_ = std::min(moves_ + 1, kMoves);
  }

  double last_ = 0.0;
  double largest_ = 0.0;  // move in a reading
  double away_s_ = 0.0;   // since the last one that was believed
  double refused_ = std::nan("");
  int moves_ = 0;
  bool seen_ = false, was_inside_ = false;
  bool settled_outside_ = false;  // it has gone on leaping there for too long to be refused
};

}  // namespace ifog
