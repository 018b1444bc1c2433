// SPDX-License-Identifier: Apache-2.0
// Fixed-interval smoothing (Rauch, Tung and Striebel, AIAA Journal 3(8), 1965) of a rate that rests here and
// moves there.
//
// At rest the rate is a random walk. Where it moves it has a slope and a curvature beside its level, and
// white noise drives the curvature: how strongly, the memory of a sample says. Level goes on from rest to
// motion and back, slope and curvature are of the motion alone. Any constant added to the level is as likely
// as none, so the sum of (measured - smoothed) over a record is zero: the angle is conserved to rounding.
#pragma once

#include <span>

#include "filters/series/samples.h"

namespace ifog {

struct Smoothed {
  Samples rate_radps, variance_rad2ps2;
};

// How quickly the rate moves at a sample: the memory of what follows it, in nominal samples.
namespace pace {
inline constexpr float kRest = 0.0F;    // as the walk says
inline constexpr float kBroken = 0.5F;  // anything may be between the sample and its neighbours; most of such
// Driving noise of the curvature over R, by nominal sample: of the Kalman filter whose gain is that of the
// fading parabola (trackers.h) of that memory.
[[nodiscard]] double jerk(double memory) noexcept;
}  // namespace pace

// One axis of a record, one of all spans a sample. All but the rate say how the rate comes from the sample
// before, and the first of each is of no meaning. What the smoothed rate is off by in a motion x is
// D^3 (D^3 x / jerk): the memory is to change slowly.
struct RateCourse {
  std::span<const double> rate;     // rad/s, NaN where missing
  std::span<const double> walk;     // variance the level walks by, (rad/s)^2, > 0
  std::span<const double> steps;    // time, nominal samples, > 0; empty: all are 1
  std::span<const float> memories;  // empty: all at rest
};

// noise: R, (rad/s)^2. Beside what it gives it keeps one filtered state in thousands, and works out the
// others again. Before the first measurement as there; NaN where there is none.
[[nodiscard]] Smoothed smooth_course(const RateCourse& course, double noise);

}  // namespace ifog
