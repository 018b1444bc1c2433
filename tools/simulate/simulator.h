// SPDX-License-Identifier: Apache-2.0
// Simulates a gyro: its measurements, its logged channels, and the truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/capture/capture.h"
#include "tools/simulate/noise.h"
#include "tools/simulate/recipe.h"

namespace ifog::simulate {

struct Scenario {
  std::string name;
  std::uint64_t seed = 1;
  double sample_rate_hz = 100.0;
  double duration_s = 0.0;
  std::vector<std::string> axes{""};
  NoiseLevels noise;  // drawn for each axis
  double bias_radps = 0.0;
  bool reference = false;  // write the reference columns
  double reference_noise_radps = 0.0;
  double time_jitter_s = 0.0;                   // of the time stamps, standard deviation; their order is kept
  double missing_rows = 0.0;                    // fraction of missing rows
  std::vector<std::pair<double, double>> gaps;  // from, to
  std::vector<Recipe> channels, motions, effects;  // completed()
};

// Data that the capture does not contain.
struct Truth {
  Scenario scenario;                                           // with all drawn values
  std::vector<std::vector<double>> true_rate_radps;            // by axis
  std::vector<std::vector<std::vector<double>>> effect_radps;  // contribution to the rate, by axis and effect
};

struct Simulation {
  Capture capture;
  Truth truth;  // rows as in the capture
};

// Reproducible. Each channel, motion, effect and noise term draws from its own stream, so that removing one
// does not change the others. Throws std::invalid_argument: an effect of an unknown channel or axis, a length
// or rate that is not positive, fewer than two rows. Calls `progress` with the number of samples done and the
// total.
using Progress = std::function<void(std::size_t done, std::size_t total)>;
[[nodiscard]] Simulation simulate(const Scenario& scenario, const Progress& progress = {});

// JSON: the scenario with its drawn values and the RMS of each effect.
[[nodiscard]] std::string truth_json(const Truth& truth);
// Capture: the true rate as the rate, and each effect as a column effect_N_FORM_radps.
[[nodiscard]] Capture truth_capture(const Truth& truth, const Capture& capture);

// Reads TOML. Throws std::runtime_error with one line: file, line, key, value, expected value; unknown keys
// are errors. A number may be drawn: { between = [low, high], log = true, either_sign = true }. `seed`
// replaces the file's seed before anything is drawn.
[[nodiscard]] Scenario read_scenario(const std::string& path, const std::uint64_t* seed = nullptr);

}  // namespace ifog::simulate
