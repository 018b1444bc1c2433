// SPDX-License-Identifier: Apache-2.0
// One measurement of all axes for the motion tests, in units of the known noise.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "filters/settings/axes.h"

namespace ifog {

// One value per axis in a vector register. The last lane has no axis.
using Lanes = Eigen::Array<double, 4, 1>;
static_assert(kMaxAxes < Lanes::SizeAtCompileTime);

[[nodiscard]] inline Lanes to_lanes(const Axes& axes) noexcept { return {axes[0], axes[1], axes[2], 0.0}; }
[[nodiscard]] inline Axes to_axes(const Lanes& lanes) noexcept { return {lanes[0], lanes[1], lanes[2]}; }
// 1 in the lane of each axis of the set, else 0.
[[nodiscard]] inline Lanes mask_of(std::uint32_t axes) noexcept {
  return {static_cast<double>(axes & 1U), static_cast<double>(axes >> 1U & 1U),
          static_cast<double>(axes >> 2U & 1U), 0.0};
}
// Axes of a sensor with this number of axes, bit i.
[[nodiscard]] constexpr std::uint32_t axes_of_sensor(std::size_t axes) noexcept { return (1U << axes) - 1U; }

// An innovation is limited to five standard deviations where it is used or summed: as a square and in nats.
// Beyond that it is an outlier.
inline constexpr double kMostDeviations = 5.0;
inline constexpr double kMostSquare = kMostDeviations * kMostDeviations;
inline constexpr double kMostNats = 0.5 * kMostSquare;
// Limit if outliers are frequent, and for comparisons of size: 20 standard deviations.
inline constexpr double kFarSquare = 400.0;
inline constexpr double kEvidence = 18.0;  // nats for a decision: by chance once in 6e7 samples
// Samples until a reset filter counts as at rest; samples that may be lost.
inline constexpr double kRestMemory = 64.0, kShortGap = 16.0;
inline constexpr double kTailMemory = 8192.0;  // averaging time of tails and outliers, samples

struct Sample {
  std::uint32_t valid = 0;
  Lanes mask = Lanes::Zero();        // 1 for valid axes
  Lanes rate = Lanes::Zero();        // rad/s; arbitrary for axes that are not valid
  Lanes innovation = Lanes::Zero();  // of the filter at rest, rad/s; 0 if not valid
  Lanes scale = Lanes::Ones();       // R of this measurement, (rad/s)^2
  Lanes inverse = Lanes::Zero();     // 1 / scale; 0 if not valid
  Lanes surprise = Lanes::Zero();    // squared innovation / its predicted variance
  Lanes covered_s = Lanes::Zero();
  Lanes short_rad = Lanes::Zero();  // angle error of the filter at rest before this sample
  double rest_factor = 1.0;         // variance of the filter's innovations / R
  // The same without the model's colour, as trackers predict: it would absorb a motion.
  Lanes apart = Lanes::Zero();
  double apart_factor = 1.0;
  Lanes decay = Lanes::Ones();  // Noise::decay(); 1 if the state model has the colour
  double louder = 1.0;          // variance that noise may have for a while / the usual one
};

// Variance of a sum with fading memory, relative to that of white noise, if neighbours' correlation is lost by the share
// `decay` per sample and the memory keeps the share `keep`.
[[nodiscard]] inline Lanes colour_of_sum(const Lanes& decay, double keep) noexcept {
  const Lanes lost = 1.0 - (1.0 - decay) * keep;
  return (2.0 - lost) / lost;
}

[[nodiscard]] inline double greatest(const Lanes& lanes) noexcept { return lanes.maxCoeff(); }

}  // namespace ifog
