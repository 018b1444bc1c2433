// SPDX-License-Identifier: Apache-2.0
// Faults of loggers: the sensor and its effects are unchanged, but not their record.
#pragma once

#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "tests/bench/undeclared/scoring.h"

namespace ifog::undeclared {

// "hole": 300 s of rows are missing. "sentinel": every thermometer reads 85 or -127 °C three times for some
// seconds. "stuck": the sensor's thermometer is constant for a fifth of the record. "glitch": one value of
// each channel is 1000 times too large.
const std::vector<std::string>& logging_faults();

// Throws std::invalid_argument for an unknown fault.
std::vector<Capture> spoilt(const std::string& fault, std::vector<Capture> captures);

// Applies the fault to every capture before `inner`.
Diagnose logged_with(const std::string& fault, Diagnose inner);

}  // namespace ifog::undeclared
