// SPDX-License-Identifier: Apache-2.0
// A simulated gyro with hidden effects: drawn from its seed, scaled in GLS sigma of its true noise, and
// recorded several times with different environments and switch-on biases.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "tests/bench/undeclared/environment.h"
#include "tests/bench/undeclared/noise.h"

namespace ifog::undeclared {

enum class Kind {
  kNothing,
  kLookalike,  // only a random walk, selected for its correlation with the temperature
  kTemperatureLinear,
  kTemperatureQuadratic,
  kTemperatureRate,
  kTemperatureLagged,
  kAcceleration,
  kSupply,
  kMagnetic,
  kLine,
  kScaleFactor,
  kScaleNonlinearity,
  kScaleTemperature,
  kStep,
  kWarmUp,
  kTwo,
  kUncovered,  // hysteresis in temperature: no form describes it
};

const char* name_of(Kind kind);
const std::vector<Kind>& kinds_with_effect();

// With the model file's names, for comparison. `backlash` is not a form.
struct TrueEffect {
  std::string form, channel, with_form, with_channel;
  double reference = 0.0;  // channel value at which the effect is zero
  double size = 0.0;       // coefficient, SI; amplitude of a line
  double shape =
      0.0;  // lag_s, bandwidth_s, frequency_hz, time_constant_s, time_s of a step, half width in degC
  double sigma =
      0.0;  // GLS visibility in the captures it is to be found in, given the sensor's other effects
};

struct Sensor {
  std::uint64_t seed = 0;
  std::uint32_t attempt = 0;  // number of draws until the effects can be distinguished
  Kind kind = Kind::kNothing;
  NoiseTruth noise;
  std::shared_ptr<const NoiseModel> noise_model;  // of one capture
  OperatingRange range;
  std::size_t samples = 0;  // of each capture
  double dt_s = 1.0;
  int captures = 1;  // diagnosed together
  std::vector<TrueEffect> effects;
  std::vector<std::string> lively;
};

struct Record {
  Capture capture;
  std::vector<std::vector<double>> effects;  // true waveforms, by effect
  std::vector<double> noise;                 // the sensor's own, without bias
  double bias = 0.0;
};

// sigma: visibility of each effect; for kTwo of both. Reproducible.
Sensor draw_sensor(std::uint64_t seed, Kind kind, double sigma, int captures = 1);

// capture 0 … captures-1 are for the diagnosis; higher numbers are other captures of the same sensor.
Record record(const Sensor& sensor, int capture);

// The visibility oracle over the captures for the diagnosis.
Visibility visibility(const Sensor& sensor);

// JSON of everything that the diagnosis must not see.
std::string truth_text(const Sensor& sensor);

}  // namespace ifog::undeclared
