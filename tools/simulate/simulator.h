// SPDX-License-Identifier: Apache-2.0
// A gyro in its surroundings: what it measures, what its channels log, and, apart from both, the truth.
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
  NoiseLevels noise;  // each axis draws its own
  double bias_radps = 0.0;
  bool reference = false;  // write the reference columns
  double reference_noise_radps = 0.0;
  double time_jitter_s = 0.0;                   // of the stamps, one standard deviation; they stay in order
  double missing_rows = 0.0;                    // fraction of rows that never arrive
  std::vector<std::pair<double, double>> gaps;  // from, to: no rows in between
  std::vector<Recipe> channels, motions, effects;  // completed()
};

// What the capture does not tell.
struct Truth {
  Scenario scenario;                                 // with every drawn value
  std::vector<std::vector<double>> true_rate_radps;  // by axis
  std::vector<std::vector<std::vector<double>>>
      effect_radps;  // by axis, by effect; the effect's own part of the rate
};

struct Simulation {
  Capture capture;
  Truth truth;  // rows as in the capture
};

// Same scenario, same bits. Each channel, motion, effect and noise term draws from a stream of its own, so
// that taking one out leaves the others as they were. Throws std::invalid_argument: an effect of a channel or
// axis that does not exist, a length or rate that is not positive, fewer than two rows. `progress` is called with how many
// samples of signals are made, and of how many.
using Progress = std::function<void(std::size_t done, std::size_t total)>;
[[nodiscard]] Simulation simulate(const Scenario& scenario, const Progress& progress = {});

// The truth for programs: the scenario with its drawn values and the RMS of each effect.
[[nodiscard]] std::string truth_json(const Truth& truth);
// The truth as a capture: the true rate as the rate, and each effect as a column effect_N_FORM_radps.
[[nodiscard]] Capture truth_capture(const Truth& truth, const Capture& capture);

// TOML. Throws std::runtime_error with one line: file, line, key, value, what was expected; unknown keys are
// errors. A number may be drawn: { between = [low, high], log = true, either_sign = true }. `seed`, where
// given, takes the place of the file's before anything is drawn.
[[nodiscard]] Scenario read_scenario(const std::string& path, const std::uint64_t* seed = nullptr);

}  // namespace ifog::simulate
