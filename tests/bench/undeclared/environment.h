// SPDX-License-Identifier: Apache-2.0
// Environment of a sensor during one capture: true and recorded values of every channel.
#pragma once

#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "tests/bench/undeclared/draw.h"

namespace ifog::undeclared {

// Operating limits of the sensor. The diagnosed captures cover all of them, like a calibration; other
// captures stay within, so that the effect is judged without extrapolation.
struct OperatingRange {
  double temperature_low = 15.0, temperature_high = 45.0;  // degC
  double temperature_step = 0.0;                           // of the recorded channel, degC; 0: hundredths
  double margin = 0.0;  // largest fraction of the temperature span that is not reached at each end
  bool has_reference = false;
  double rate_max = 1.0;  // rad/s, of the motion measured by the reference
};

struct Channel {
  std::string name;
  std::vector<double> truth, recorded;
};

struct Environment {
  double dt_s = 1.0;
  std::vector<double> time_s;
  std::vector<Channel> channels;
  std::vector<double> reference_radps;  // empty without a reference

  [[nodiscard]] const Channel& channel(const std::string& name) const;
};

// `lively`: channels that must vary in this capture; others may be constant.
Environment draw_environment(const OperatingRange& range, std::size_t samples, double dt_s,
                             const std::vector<std::string>& lively, Draw& draw);

const std::vector<std::string>& channel_names();

// First-order low-pass with time constant tau_s, settled at the first value.
std::vector<double> low_passed(const std::vector<double>& x, double tau_s, double dt_s);

}  // namespace ifog::undeclared
