// SPDX-License-Identifier: Apache-2.0
// The filter of one sensor: all its axes, one state model, one adaptation rule, one gain for all axes.
//
// step() is the daemon's hot path: no allocation, no lock, no log, no exception. Everything it does depends
// only on the settings and on the sequence of its arguments, so that a replay gives the same bits.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "filters/estimator/learned_noise.h"
#include "filters/settings/axes.h"
#include "filters/settings/filter_settings.h"

namespace ifog {

struct EstimatorInput {
  std::uint64_t sequence = 0;    // unwrapped; also the counter of the random weights
  double dt_s = 0.0;             // time covered by this sample; after a gap, the whole gap
  Axes rate_radps{};             // compensated mean rate over dt
  std::uint32_t valid_axes = 0;  // bit i; an axis that is not valid is only predicted
  // By axis, of dt the time in which the rate was measured: what a gap hides is no angle, and none is owed
  // for it. 0: all of dt.
  Axes covered_s{};
  std::uint32_t stuck_axes = 0;  // whose sensor repeats one value: they are only predicted
  double averaged_s = 0.0;  // time the rate is a mean over (white noise falls with it); 0: the nominal period
};

enum EstimatorFlags : std::uint32_t {
  kGated = 1,  // a measurement was kept out as an outlier
  // A change of rate was detected, covariance raised. A filter that begins under way follows from its first
  // measurement on, and says so once that is known.
  kManoeuvre = 2,
  kRestarted = 4,  // divergence: the filter started again from this measurement
  kStuck = 8,      // the sensor repeats one value
  // All axes rest: no change of rate is found or suspected, none has been for 64 measurements, and no axis
  // turns faster than 0.02 rad/s. A rate that is constant, or drifts as slowly as the noise, is not told from
  // rest. Never without FilterSettings::follow_manoeuvres.
  kAtRest = 16,
};

struct EstimatorOutput {
  Axes denoised_radps{};
  Axes variance_rad2ps2{};
  Axes innovation_radps{};
  Axes innovation_variance{};
  Axes gain{};
  std::uint32_t flags = 0;
};

// Figures for the status message; counters only grow. NIS and whiteness are of the filter at rest, and stand
// still in a manoeuvre.
struct EstimatorHealth {
  Axes nis_mean{};   // exponentially averaged, 1 when the filter believes itself rightly
  Axes whiteness{};  // lag-1 autocorrelation of the innovations
  Axes measurement_noise{};
  Axes colour{1.0, 1.0, 1.0};  // variance of the innovations over that of white noise as rough as they are
  double group_delay_s = 0.0;
  double correlation_time_s = 0.0;
  std::uint64_t gated = 0, manoeuvres = 0, floor_hits = 0, divergences = 0, restarts = 0;
};

// What is known of the noise besides FilterSettings.
struct KnownNoise {
  // Each axis' own noise over FilterSettings::measurement_noise, by which it is judged until it is heard.
  Axes share{1.0, 1.0, 1.0};
  // Each axis' own driving noise over FilterSettings::process_noise. Empty: it goes with the axis' noise.
  std::optional<Axes> walk_share;
  // FilterSettings::process_noise is a first guess that is improved at rest; an earlier run has found it in so
  // many samples, 0: nobody has.
  bool learns_walk = false;
  double samples = 0.0;
};

class Estimator {
 public:
  // Throws std::invalid_argument naming the setting, its value and what was expected.
  // nominal_period_s > 0; axes 1 … kMaxAxes.
  Estimator(const FilterSettings& settings, int axes, double nominal_period_s, const KnownNoise& known = {});
  ~Estimator();
  Estimator(Estimator&&) noexcept;
  Estimator& operator=(Estimator&&) noexcept;

  void step(const EstimatorInput& in, EstimatorOutput& out) noexcept;
  // Angle by which the denoised rate has fallen short of the measured one and which is still to be paid back,
  // rad; 0 with conserve_angle off. A new estimator that takes the place of this one is told before its first
  // step, so that a reload in a turn loses none.
  [[nodiscard]] Axes owed() const noexcept;
  void owe(const Axes& angle_rad) noexcept;
  // The noise as it is known now.
  [[nodiscard]] LearnedNoise learned() const noexcept;
  [[nodiscard]] const EstimatorHealth& health() const noexcept;

 private:
  std::unique_ptr<class Engine> engine_;
};

}  // namespace ifog
