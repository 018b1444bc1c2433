// SPDX-License-Identifier: Apache-2.0
// Compares a diagnosis with the hidden effects, first by names and then with an oracle.
//
// A true effect is found *exactly* if form and channel (and the partner of a product) have the hidden names.
// It is found *equivalently* if other names reproduce the hidden waveforms so well that the difference is
// below 3 sigma in the diagnosed captures: then nobody could distinguish them, even with the true noise
// known. Both count as right and are reported separately. Every other found effect is extra; an equivalent
// explanation must not have superfluous parts. A parabola is claimed with a linear term that places its
// turning point: within 3 sigma of the hidden one this is part of the law and counts as completed.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "filters/diagnosis/diagnose.h"
#include "tests/bench/undeclared/sensor.h"

namespace ifog::undeclared {

struct Claim {
  Effect effect;
  // rad/s over a capture, causal, as the daemon would subtract it; for the diagnosed captures including what
  // only they have.
  std::function<std::vector<double>(const Capture&)> waveform;
};

struct Finding {
  std::vector<Claim> effects;
  bool unexplained = false;                 // "something is left that no form describes"
  std::vector<std::string> contradictions;  // of the report with itself
  // Prediction for another capture of the sensor from its times and channels; empty if there is none.
  std::function<HeadingPrediction(const Capture& next)> heading;
};

using Diagnose = std::function<Finding(const std::vector<Capture>&)>;

struct Parameter {
  std::string name;  // "linear temperature_degC coefficient"
  double error_in_sigma = 0.0;
  // Standard error relative to the oracle, which knows the noise and all shapes; 0 if there is none.
  double width = 0.0;
};

struct Score {
  Kind kind = Kind::kNothing;
  std::uint64_t seed = 0;
  double sigma = 0.0;
  int hidden = 0, exact = 0, equivalent = 0, missed = 0, extra = 0, completed = 0;
  bool unexplained = false;
  // On another capture: RMS of 10 s means of (estimated - true effect), and of the true effect, divided by
  // the RMS of 10 s means of the sensor's noise about its mean. `shape_error` excludes the mean, which a
  // switch-on bias hides.
  double effect_error = 0.0, shape_error = 0.0, effect_size = 0.0;
  bool transferable = true;  // false: a step, or a line whose phase in another capture is unknown
  std::vector<Parameter> parameters;
  // (heading error found / predicted)^2 on another capture, at the longest predicted time within it.
  std::optional<double> heading_square;
  std::string names;                        // found effects, for the log
  std::vector<std::string> contradictions;  // as in Finding
  double seconds = 0.0;

  [[nodiscard]] bool right() const { return missed == 0; }
};

Score score(const Sensor& sensor, const Diagnose& diagnose);

// Means of consecutive blocks of `seconds`; an incomplete last one is dropped.
std::vector<double> block_means(const std::vector<double>& x, double dt_s, double seconds);

std::string name_of(const Effect& effect);

}  // namespace ifog::undeclared
