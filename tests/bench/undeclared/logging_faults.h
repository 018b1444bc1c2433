// SPDX-License-Identifier: Apache-2.0
// What loggers do to a capture: the sensor and its effects are as they were, the record of them is not.
#pragma once

#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "tests/bench/undeclared/scoring.h"

namespace ifog::undeclared {

// "hole": 300 s of rows are missing; "sentinel": every thermometer says 85 or -127 °C three times for some
// seconds; "stuck": the sensor's thermometer stands still for a fifth of the record; "glitch": one value of
// each channel is a thousand times its size.
const std::vector<std::string>& logging_faults();

// Throws std::invalid_argument for an unknown fault.
std::vector<Capture> spoilt(const std::string& fault, std::vector<Capture> captures);

// `inner` with every capture that it is given spoilt so.
Diagnose logged_with(const std::string& fault, Diagnose inner);

}  // namespace ifog::undeclared
