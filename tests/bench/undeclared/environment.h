// SPDX-License-Identifier: Apache-2.0
// What surrounds a sensor during one capture: every channel as the physics sees it and as it was recorded.
#pragma once

#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "tests/bench/undeclared/draw.h"

namespace ifog::undeclared {

// Limits the sensor lives between. The captures diagnosed go through all of them, as a calibration does; any
// other capture stays within, so that what is judged is the effect and not the hold at the edge of the fitted
// range.
struct OperatingRange {
  double temperature_low = 15.0, temperature_high = 45.0;  // degC
  double temperature_step = 0.0;                           // of the recorded channel, degC; 0: hundredths
  double margin = 0.0;  // of the temperature span, left out at each end by up to this share
  bool has_reference = false;
  double rate_max = 1.0;  // rad/s, of the motion under the reference
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

// `lively` names the channels that must move in this capture; the others may as well stand still.
Environment draw_environment(const OperatingRange& range, std::size_t samples, double dt_s,
                             const std::vector<std::string>& lively, Draw& draw);

const std::vector<std::string>& channel_names();

// First-order low-pass, time constant tau_s, that starts settled at the first value.
std::vector<double> low_passed(const std::vector<double>& x, double tau_s, double dt_s);

}  // namespace ifog::undeclared
