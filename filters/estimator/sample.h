// SPDX-License-Identifier: Apache-2.0
// One measurement of all axes as the tests of motion see it, in the units of the known noise.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "filters/settings/axes.h"

namespace ifog {

// One number of each axis side by side, so that a step of all axes is one of vector registers. The last has no
// axis.
using Lanes = Eigen::Array<double, 4, 1>;
static_assert(kMaxAxes < Lanes::SizeAtCompileTime);

[[nodiscard]] inline Lanes to_lanes(const Axes& axes) noexcept { return {axes[0], axes[1], axes[2], 0.0}; }
[[nodiscard]] inline Axes to_axes(const Lanes& lanes) noexcept { return {lanes[0], lanes[1], lanes[2]}; }
// 1 in the lane of each axis of the set, else 0.
[[nodiscard]] inline Lanes mask_of(std::uint32_t axes) noexcept {
  return {static_cast<double>(axes & 1U), static_cast<double>(axes >> 1U & 1U),
          static_cast<double>(axes >> 2U & 1U), 0.0};
}
// The axes that a sensor of so many has, bit i.
[[nodiscard]] constexpr std::uint32_t axes_of_sensor(std::size_t axes) noexcept { return (1U << axes) - 1U; }

// An innovation counts for five standard deviations at most where it is taken in or summed: as a square, and as
// nats. One beyond is an outlier.
inline constexpr double kMostDeviations = 5.0;
inline constexpr double kMostSquare = kMostDeviations * kMostDeviations;
inline constexpr double kMostNats = 0.5 * kMostSquare;
// Where outliers are frequent, and where sizes are compared, those up to 20 standard deviations are measurements.
inline constexpr double kFarSquare = 400.0;
inline constexpr double kEvidence = 18.0;  // nats that decide: by chance once in 6e7 samples
// Samples after which a filter that was moved is one at rest again; and that may be lost in a row, or pass until
// an outlier is explained.
inline constexpr double kRestMemory = 64.0, kShortGap = 16.0;
inline constexpr double kTailMemory = 8192.0;  // samples over which tails and outliers are averaged

struct Sample {
  std::uint32_t valid = 0;
  Lanes mask = Lanes::Zero();        // 1 where valid
  Lanes rate = Lanes::Zero();        // rad/s; where not valid, any number
  Lanes innovation = Lanes::Zero();  // of the filter at rest, rad/s; 0 where not valid
  Lanes scale = Lanes::Ones();       // R of this measurement, (rad/s)^2
  Lanes inverse = Lanes::Zero();     // 1 / scale; 0 where not valid
  Lanes surprise = Lanes::Zero();    // square of the innovation over its predicted variance
  Lanes covered_s = Lanes::Zero();
  Lanes short_rad = Lanes::Zero();  // angle that the filter at rest has fallen short of before it
  double rest_factor = 1.0;         // variance of the filter's innovations over R
};

[[nodiscard]] inline double greatest(const Lanes& lanes) noexcept { return lanes.maxCoeff(); }

}  // namespace ifog
