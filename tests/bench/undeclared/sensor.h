// SPDX-License-Identifier: Apache-2.0
// A simulated gyro with hidden effects: drawn from its seed, sized in GLS sigma against its own true noise,
// and recorded as often as wanted, each time in another environment and with another switch-on bias.
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
  kLookalike,  // nothing but a random walk, the one of many that follows the temperature best
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

// In the model file's terms, so that what was found can be compared by name. `backlash` is in no list of
// forms.
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
  std::uint32_t attempt = 0;  // of drawing effects that can be told apart
  Kind kind = Kind::kNothing;
  NoiseTruth noise;
  std::shared_ptr<const NoiseModel> noise_model;  // of one capture
  OperatingRange range;
  std::size_t samples = 0;  // of each capture
  double dt_s = 1.0;
  int captures = 1;  // to be diagnosed together
  std::vector<TrueEffect> effects;
  std::vector<std::string> lively;
};

struct Record {
  Capture capture;
  std::vector<std::vector<double>> effects;  // true waveforms, by effect
  std::vector<double> noise;                 // the sensor's own, without bias
  double bias = 0.0;
};

// sigma: visibility of each effect; for kTwo of both. The same arguments give the same sensor.
Sensor draw_sensor(std::uint64_t seed, Kind kind, double sigma, int captures = 1);

// capture 0 … captures-1 are for the diagnosis; any higher number is another capture of the same sensor.
Record record(const Sensor& sensor, int capture);

// The visibility oracle over the captures for the diagnosis.
Visibility visibility(const Sensor& sensor);

// JSON of everything the diagnosis must not see.
std::string truth_text(const Sensor& sensor);

}  // namespace ifog::undeclared
