// SPDX-License-Identifier: Apache-2.0
// The nonlinearity of a rebuilt feedback ramp as a table over its cycle, fitted by harmonics over the angle.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "filters/diagnosis/ramp/ramp_comb.h"
#include "filters/effects/ramp_tracker.h"

namespace ifog {

inline constexpr std::size_t kRampParts = 4;  // held out in turn

// Which of them a sample is in; each is made of four pieces, spread over the record.
inline std::size_t ramp_part(std::size_t sample, std::size_t samples) {
  return sample * 4 * kRampParts / samples % kRampParts;
}

struct RampTable {
  double cycles_per_rad = 0.0, cycles_error = 0.0;
  Eigen::VectorXd harmonics;                     // cosine and sine of each, rad
  double angle_error = 0.0;                      // standard deviation of the table's values, rad
  double noise_density = 0.0, phase_walk = 0.0;  // as RampSettings
  double noise_error = 0.0, walk_error = 0.0;
  std::array<Eigen::VectorXd, kRampParts> harmonics_without{};  // fitted to the other parts

  // Four values a harmonic, rad.
  [[nodiscard]] std::vector<double> one_cycle() const;
  [[nodiscard]] RampSettings settings() const;
  [[nodiscard]] RampTable without(std::size_t part) const;
};

// With as many harmonics as predict the parts held out of their fit best; nothing when none do.
std::optional<RampTable> fit_ramp_table(const UnbrokenPart& part, const RampComb& comb);

}  // namespace ifog
