// SPDX-License-Identifier: Apache-2.0
// What a diagnosis said against what was hidden, by names first and by an oracle second.
//
// A true effect is found *exactly* when form and channel (and the partner of a product) are named as hidden.
// It is found *equivalently* when other names were given, but their waveforms reproduce the hidden ones so
// well that what is left would be visible below 3 sigma in the captures diagnosed: with the true noise known,
// nobody could have distinguished them. Both count as right; they are reported separately. Every found effect that is
// neither is extra; an equivalent explanation must also be free of parts that it could do without. A parabola
// is claimed with the straight line that places its turning point: within 3 sigma of where the hidden one is
// that is the hidden law's own term, counted as completed.
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
  // rad/s over a capture, causal, as the daemon would subtract it; over those diagnosed also what only those
  // had.
  std::function<std::vector<double>(const Capture&)> waveform;
};

struct Finding {
  std::vector<Claim> effects;
  bool unexplained = false;                 // "something is left that no form describes"
  std::vector<std::string> contradictions;  // of the report with itself
  // Of another capture of the sensor, from its times and channels alone; empty when none is made.
  std::function<HeadingPrediction(const Capture& next)> heading;
};

using Diagnose = std::function<Finding(const std::vector<Capture>&)>;

struct Parameter {
  std::string name;  // "linear temperature_degC coefficient"
  double error_in_sigma = 0.0;
  // Standard error over that of the oracle, which knows the noise and every shape; 0 where there is none.
  double width = 0.0;
};

struct Score {
  Kind kind = Kind::kNothing;
  std::uint64_t seed = 0;
  double sigma = 0.0;
  int hidden = 0, exact = 0, equivalent = 0, missed = 0, extra = 0, completed = 0;
  bool unexplained = false;
  // On another capture: RMS of 10 s means of (estimated - true effect) and of the true effect, over the RMS
  // of 10 s means of the sensor's own noise about its mean. `shape_error` leaves the mean out, which a
  // switch-on bias hides.
  double effect_error = 0.0, shape_error = 0.0, effect_size = 0.0;
  bool transferable = true;  // false: a step, or a line, whose phase in another capture nothing can tell
  std::vector<Parameter> parameters;
  // (heading error found / predicted)^2 on another capture, at the longest time predicted that it holds.
  std::optional<double> heading_square;
  std::string names;                        // what was found, for the log
  std::vector<std::string> contradictions;  // as Finding has them
  double seconds = 0.0;

  [[nodiscard]] bool right() const { return missed == 0; }
};

Score score(const Sensor& sensor, const Diagnose& diagnose);

// Means of consecutive blocks of `seconds`; the incomplete last one is dropped.
std::vector<double> block_means(const std::vector<double>& x, double dt_s, double seconds);

std::string name_of(const Effect& effect);

}  // namespace ifog::undeclared
