// SPDX-License-Identifier: Apache-2.0
// Filter of one sensor: all axes, one state model, one adaptation rule, one common gain.
//
// step() is the daemon's hot path: no allocation, lock, log or exception. The results depend only on the
// settings and the sequence of arguments, so a replay reproduces them bit for bit.
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
  double dt_s = 0.0;             // time of this sample; after a gap, the whole gap
  Axes rate_radps{};             // compensated mean rate over dt
  std::uint32_t valid_axes = 0;  // bit i; other axes are only predicted
  // By axis, the part of dt in which the rate was measured. Angle in gaps is unknown and not paid back. 0:
  // all of dt.
  Axes covered_s{};
  std::uint32_t stuck_axes = 0;  // bit i; axes whose sensor repeats one value; they are only predicted
  double averaged_s = 0.0;       // averaging time of the rate (determines white noise); 0: the nominal period
};

enum EstimatorFlags : std::uint32_t {
  kGated = 1,  // a measurement was rejected as an outlier
  // A change of rate was detected and the covariance raised. After a start in motion the flag is set as soon
  // as the motion is certain.
  kManoeuvre = 2,
  kRestarted = 4,  // divergence: the filter restarted from this measurement
  kStuck = 8,      // the sensor repeats one value
  // All axes are at rest: no change of rate is detected or suspected, none was for 64 measurements, and no
  // axis exceeds 0.02 rad/s. A constant rate, or a drift as slow as the noise, is not distinguished from
  // rest. Never set without FilterSettings::follow_manoeuvres.
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

// Figures for the status message; counters only grow. NIS and whiteness are those of the filter at rest and
// do not change in a manoeuvre.
struct EstimatorHealth {
  Axes nis_mean{};   // exponentially averaged; 1 if the predicted variance is right
  Axes whiteness{};  // autocorrelation of the innovations at lag 1
  Axes measurement_noise{};
  double group_delay_s = 0.0;
  double correlation_time_s = 0.0;
  std::uint64_t gated = 0, manoeuvres = 0, floor_hits = 0, divergences = 0;
};

// Knowledge of the noise in addition to FilterSettings.
struct KnownNoise {
  // Noise variance of each axis / FilterSettings::measurement_noise, with the model's colour, until it is learned.
  Axes share{1.0, 1.0, 1.0};
  // Driving noise of each axis / FilterSettings::process_noise. nullopt: in proportion to the axis's noise.
  std::optional<Axes> walk_share;
  // The noise variances are those of long means, times their number of samples: any colour is within them.
  bool of_long_means = false;
  // FilterSettings::process_noise is a start value that is improved at rest. samples: number of samples from
  // which an earlier run has learned it, 0: none.
  bool learns_walk = false;
  double samples = 0.0;
};

class Estimator {
 public:
  // Throws std::invalid_argument that names the setting, its value and what was expected. nominal_period_s >
  // 0; axes 1 … kMaxAxes.
  Estimator(const FilterSettings& settings, int axes, double nominal_period_s, const KnownNoise& known = {});
  ~Estimator();
  Estimator(Estimator&&) noexcept;
  Estimator& operator=(Estimator&&) noexcept;

  void step(const EstimatorInput& in, EstimatorOutput& out) noexcept;
  // Angle still to be paid back, rad: measured minus denoised rate, integrated; 0 if conserve_angle is off. A
  // new estimator that replaces this one gets it by owe() before its first step, so that a reload in a turn
  // loses no angle.
  [[nodiscard]] Axes owed() const noexcept;
  void owe(const Axes& angle_rad) noexcept;
  // Current estimate of the noise.
  [[nodiscard]] LearnedNoise learned() const noexcept;
  [[nodiscard]] const EstimatorHealth& health() const noexcept;

 private:
  std::unique_ptr<class Engine> engine_;
};

}  // namespace ifog
