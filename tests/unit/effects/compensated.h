// SPDX-License-Identifier: Apache-2.0
// One sample through a compensator, and effects to make its models of.
#pragma once

#include "filters/effects/compensator.h"
#include "tests/unit/test.h"

namespace ifog {

inline const double kMissing = std::numeric_limits<double>::quiet_NaN();

inline Effect linear(double coefficient) {
  Effect effect;
  effect.form = "linear";
  effect.channel = "temperature_degC";
  effect.reference = 25.0;
  effect.parameters = {{"coefficient", coefficient, 0.0, "rad/s/degC"}};
  return effect;
}

inline Effect of_rate(const char* form, double coefficient) {
  Effect effect;
  effect.form = form;
  effect.channel = "reference_rate_radps";
  effect.parameters = {{"coefficient", coefficient, 0.0, ""}};
  return effect;
}

inline CompensatorOutput step(Compensator& compensator, double rate, std::vector<double> channels,
                              double age = 0.0) {
  CompensatorInput in;
  in.dt_s = 0.01;
  in.rate_radps = {rate, rate, rate};
  in.channels = channels;
  const std::vector<double> ages(channels.size(), age);
  in.age_s = ages;
  CompensatorOutput out;
  compensator.step(in, out);
  return out;
}

}  // namespace ifog
