// SPDX-License-Identifier: Apache-2.0
// Motion of the structure under a sensor, which is in the rate but is not a sensor error.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/undeclared/scoring.h"

namespace ifog::undeclared {

// "tower": sways at 0.54 Hz, a resonance with Q 20 to 40 driven by white noise, 10 to 50 times the sensor's
// white noise in means of one second. "machine": also a line that drifts slowly by a tenth of its frequency.
// The effects' visibility is nearly unchanged: they are slower, and a fit can whiten the motion's spectrum.
const std::vector<std::string>& structures();

// Adds the motion to the captures' rates; reproducible. Throws std::invalid_argument for an unknown
// structure.
std::vector<Capture> standing_on(const std::string& structure, const Sensor& sensor,
                                 std::vector<Capture> captures);

// Applies the motion to every capture before `inner`.
Diagnose moved_by(const std::string& structure, const Sensor& sensor, Diagnose inner);

}  // namespace ifog::undeclared
