// SPDX-License-Identifier: Apache-2.0
// What a sensor's filter is given: state model, noise, adaptation rule. Read from [sensor.filter] of the
// daemon's configuration, from [filter] of a model file and from the command line by one table,
// filter_table.h, which also says what each of these may be.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ifog {

struct FilterSettings {
  std::string rule = "irwe-akfg";     // a name from the list in filters/rules
  std::string state = "random-walk";  // a name from the list in filters/state_models, or a sum of them

  // Variances per second of the driving noise and per sample of the measurement. For the random walk: process
  // noise spectral density of the rate, (rad/s)^2/s; measurement variance at the nominal period, (rad/s)^2.
  double process_noise = 0.0;      // 0: not given; from the model file, else from start-up data
  double measurement_noise = 0.0;  // 0: not given, likewise
  // Parameters of the state model: AR/MA coefficients, correlation time, line frequency…
  std::vector<double> state_parameters;

  int window = 50;  // N of IRWE, IAE, RAE
  // What exceeds the known noise: "motion", which is followed, or "noise", which is smoothed.
  std::string wideband = "motion";
  std::string weights = "kept";   // "kept" | "fresh" | "uniform"
  int draws = 1;                  // B: average of this many weight draws
  double floor = 0.01;            // epsilon of the floor on the innovation covariance; 0 switches it off
  bool follow_manoeuvres = true;  // the cure for inertia
  bool conserve_angle = true;     // integral of (denoised - compensated) returns to zero
  bool steady_gain = true;        // the rule's window is 1000 samples at least, so that the gain is steady
  bool guard = true;              // a filter that has diverged starts again
  bool plain = false;             // the rule's filter and nothing else: the four above off, no floor
  std::uint64_t seed = 1;         // of the weights
};

// What one source says of it. Empty: not said. Meanings and units as in FilterSettings.
struct FilterChoice {
  std::optional<std::string> rule, state, weights, wideband;
  std::optional<double> process_noise, measurement_noise, floor;
  std::optional<std::vector<double>> state_parameters;
  std::optional<int> window, draws;
  std::optional<bool> follow_manoeuvres, conserve_angle, steady_gain, guard, plain;
  std::optional<std::uint64_t> seed;
};

}  // namespace ifog
