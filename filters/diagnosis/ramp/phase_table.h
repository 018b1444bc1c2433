// SPDX-License-Identifier: Apache-2.0
// Nonlinearity of a feedback ramp as a table over its cycle. The angle error is f(phase); the rate error is
// the difference of f between samples divided by dt. The phase comes from a logged counter or from the
// measured angle.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "filters/diagnosis/record.h"

namespace ifog {

inline constexpr double kSlowSamples = 512.0;  // length of the running mean that removes the slow part

// Record with the ramp's phase at each sample, in cycles modulo one; NaN: unknown.
struct PhasedRecord {
  const Record* record;
  std::function<double(std::size_t)> cycles;
};

// Known phases of a sample and the one before it.
struct PhaseStep {
  double before, now;  // cycles, in [0, 1)
  double dt_s;
  double error_radps;  // rate minus the reference, if any, minus the slow part
};

// Angles (rad) at even steps after the start of the cycle, where the angle is zero. The last one is at the
// end of the cycle; it is not zero if the flyback is not exactly 2 pi.
struct PhaseTable {
  Eigen::VectorXd angle_rad;
  double angle_error = 0.0;  // standard deviation of one angle
  double samples = 0.0;
  double square = 0.0, explained = 0.0;  // sum of squares of the errors, (rad/s)^2

  [[nodiscard]] double left() const { return std::max(square - explained, 1e-12 * square); }
  // Gain of twice the log-likelihood in white noise.
  [[nodiscard]] double ratio() const { return samples * std::log(square / left()); }
  // ratio() minus the cost of the angles (Bayesian information criterion).
  [[nodiscard]] double score() const {
    return ratio() - static_cast<double>(angle_rad.size()) * std::log(samples);
  }
};

// Angle between the table's steps, linearly interpolated.
double angle_at(const Eigen::VectorXd& angle_rad, double cycles);

// Rate error by the table, rad/s.
inline double ramp_rate(const Eigen::VectorXd& angle_rad, const PhaseStep& step) {
  return (angle_at(angle_rad, step.now) - angle_at(angle_rad, step.before)) / step.dt_s;
}

// Calls use(sample, step) for each sample. The slow part is the mean of the samples so far, at most 512, as
// in the online correction (ramp_tracker.h).
template <class Use>
void each_phase_step(const PhasedRecord& of, Use&& use) {
  const Record& record = *of.record;
  double slow = 0.0, weight = 0.0, before = std::nan("");
  for (std::size_t i = 0; i < record.time_s.size(); ++i) {
    const double cycles = of.cycles(i);
    const double now = cycles - std::floor(cycles);
    const double error = record.error(i);
    const double earlier = std::exchange(before, now);
    if (!std::isfinite(error)) continue;
    if (weight > 0.0 && std::isfinite(earlier) && std::isfinite(now))
      use(i, PhaseStep{earlier, now, record.time_s[i] - record.time_s[i - 1], error - slow});
    weight = std::min(weight + 1.0, kSlowSamples);
    slow += (error - slow) / weight;
  }
}

// The number of steps minimises the Bayesian information criterion, with at least 100 samples per step (then
// the table absorbs 0.5 % of the noise). nullopt if the records are too short.
std::optional<PhaseTable> fit_phase_table(const std::vector<PhasedRecord>& records);

// Part of the errors' sum of squares that a table of `steps` explains, (rad/s)^2.
double explained_by_table(const std::vector<PhasedRecord>& records, Eigen::Index steps);

}  // namespace ifog
