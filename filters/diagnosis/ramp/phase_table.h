// SPDX-License-Identifier: Apache-2.0
// The nonlinearity of a feedback ramp as a table over its cycle: an error of the angle, f(phase), which makes
// of the rate the difference of f from sample to sample over the time between. The phase comes from a counter
// that was logged, or from the angle that the sensor has measured.
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

// A record with the phase of its ramp at each sample, in cycles of which whole ones do not count; NaN: unknown.
struct PhasedRecord {
  const Record* record;
  std::function<double(std::size_t)> cycles;
};

// Phase of a sample and of the one before it, both known.
struct PhaseStep {
  double before, now;  // cycles, in [0, 1)
  double dt_s;
  double error_radps;  // rate, less the reference if there is one, less its slow part
};

// Angles (rad) at even steps of the cycle, behind its start, where the angle is zero. The last one is where
// the cycle ends: a flyback is not exactly 2 pi, so that it need not be zero.
struct PhaseTable {
  Eigen::VectorXd angle_rad;
  double angle_error = 0.0;  // standard deviation of an angle
  double samples = 0.0;
  double square = 0.0, explained = 0.0;  // of the errors, (rad/s)^2

  [[nodiscard]] double left() const { return std::max(square - explained, 1e-12 * square); }
  // Twice the log-likelihood that the table gains in white noise.
  [[nodiscard]] double ratio() const { return samples * std::log(square / left()); }
  // The same less what its angles cost by the Bayesian information criterion.
  [[nodiscard]] double score() const {
    return ratio() - static_cast<double>(angle_rad.size()) * std::log(samples);
  }
};

// Angle of a table between two of its steps.
double angle_at(const Eigen::VectorXd& angle_rad, double cycles);

// What the table makes of a rate, rad/s.
inline double ramp_rate(const Eigen::VectorXd& angle_rad, const PhaseStep& step) {
  return (angle_at(angle_rad, step.now) - angle_at(angle_rad, step.before)) / step.dt_s;
}

// use(sample, step) for each. The slow part is a mean of all samples so far, at last of 512: as the correction
// online takes it out (see ramp_tracker.h).
template <class Use>
void each_phase_step(const PhasedRecord& of, Use&& use) {
  const Record& record = *of.record;
  double slow = 0.0, weight = 0.0, before = std::nan("");
  for (std::size_t i = 0; i < record.time_s.size(); ++i) {
    const double cycles = of.cycles(i);
    const double now = cycles - std::floor(cycles);
    double error = record.rate_radps[i];
    if (!record.reference_radps.empty()) error -= record.reference_radps[i];
    const double earlier = std::exchange(before, now);
    if (!std::isfinite(error)) continue;
    if (weight > 0.0 && std::isfinite(earlier) && std::isfinite(now))
      use(i, PhaseStep{earlier, now, record.time_s[i] - record.time_s[i - 1], error - slow});
    weight = std::min(weight + 1.0, kSlowSamples);
    slow += (error - slow) / weight;
  }
}

// With enough steps for the table's shape and no more, by the Bayesian information criterion, and a hundred
// samples for each of them, by which a table takes half a per cent of noise for its own; nothing where the
// records are too short for any.
std::optional<PhaseTable> fit_phase_table(const std::vector<PhasedRecord>& records);

// What a table of so many steps explains of the errors, (rad/s)^2.
double explained_by_table(const std::vector<PhasedRecord>& records, Eigen::Index steps);

}  // namespace ifog
