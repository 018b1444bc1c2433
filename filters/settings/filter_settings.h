// SPDX-License-Identifier: Apache-2.0
// Settings of a sensor's filter: state model, noise, adaptation rule. Read from [sensor.filter] of the
// daemon's configuration, [filter] of a model file and the command line by filter_table.h, which gives their
// ranges.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ifog {

struct FilterSettings {
  std::string rule = "irwe-akfg";     // a name from filters/rules
  std::string state = "random-walk";  // a name from filters/state_models, or a sum of them

  // Driving noise per second and measurement variance per sample. For the random walk: spectral density of
  // the rate's derivative, (rad/s)^2/s; variance at the nominal period, (rad/s)^2.
  double process_noise = 0.0;      // 0: not given; from the model file, else learned
  double measurement_noise = 0.0;  // 0: not given, as above
  // Parameters of the state model: AR/MA coefficients, correlation time, line frequency, …
  std::vector<double> state_parameters;

  int window = 50;  // N of IRWE, IAE, RAE
  // What exceeds the known noise: "motion" (followed) or "noise" (smoothed).
  std::string wideband = "motion";
  std::string weights = "kept";   // "kept" | "fresh" | "uniform"
  int draws = 1;                  // B: number of weight draws averaged
  double floor = 0.01;            // epsilon of the floor on the innovation covariance; 0: off
  bool follow_manoeuvres = true;  // track manoeuvres without the lag of the filter at rest
  bool conserve_angle = true;     // integral of (denoised - compensated) returns to zero
  bool steady_gain = true;        // window of at least 1000 samples, so that the gain is steady
  bool guard = true;              // a diverged filter restarts
  bool plain = false;             // only the rule's filter: the four above off, no floor
  std::uint64_t seed = 1;         // of the weights
};

// Settings from one source; nullopt: not given. Meanings and units as in FilterSettings.
struct FilterChoice {
  std::optional<std::string> rule, state, weights, wideband;
  std::optional<double> process_noise, measurement_noise, floor;
  std::optional<std::vector<double>> state_parameters;
  std::optional<int> window, draws;
  std::optional<bool> follow_manoeuvres, conserve_angle, steady_gain, guard, plain;
  std::optional<std::uint64_t> seed;
};

}  // namespace ifog
