// SPDX-License-Identifier: Apache-2.0
// Fixed-interval smoothing (Rauch, Tung and Striebel, AIAA Journal 3(8), 1965) of a rate with rest and
// motion.
//
// At rest the rate is a random walk. In motion it has level, slope and curvature, and white noise drives the
// curvature with a strength that follows from the sample's memory. The level continues between rest and
// motion. The model is invariant to a constant added to the level, so the sum of (measured - smoothed) over a
// record is zero: the angle is conserved to rounding.
#pragma once

#include <span>

#include "filters/series/samples.h"

namespace ifog {

struct Smoothed {
  Samples rate_radps, variance_rad2ps2;
};

// Memory of the tracker that follows the motion, in nominal samples.
namespace pace {
inline constexpr float kRest = 0.0F;  // at rest
// This and smaller values: any change is possible between the sample and its neighbours.
inline constexpr float kBroken = 0.5F;
// Driving noise of the curvature / R, per nominal sample, for which the Kalman filter has the gain of the
// fading-memory parabola (trackers.h) of that memory.
[[nodiscard]] double jerk(double memory) noexcept;
}  // namespace pace

// One axis of a record; one value per sample. Except the rate, values describe the step from the sample
// before; the first ones are ignored. The smoothing error of a motion x is D^3 (D^3 x / jerk), so the memory
// must change slowly.
struct RateCourse {
  std::span<const double> rate;     // rad/s, NaN if missing
  std::span<const double> walk;     // variance of the level's random walk, (rad/s)^2, > 0
  std::span<const double> steps;    // nominal samples, > 0; empty: all 1
  std::span<const float> memories;  // empty: all at rest
};

// Smooths one axis. noise: R, (rad/s)^2. Stores every few thousandth filtered state and recomputes the
// others. Samples before the first measurement get its value; all NaN without measurements.
[[nodiscard]] Smoothed smooth_course(const RateCourse& course, double noise);

}  // namespace ifog
