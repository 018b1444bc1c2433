// SPDX-License-Identifier: Apache-2.0
// What a sensor stands on: motion, which is in the rate and is no error of the sensor.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/undeclared/scoring.h"

namespace ifog::undeclared {

// "tower": sways at 0.54 Hz, a resonance of Q 20 to 40 excited by white noise, 10 to 50 times the sensor's
// white noise in means of a second; "machine": also a line that wanders slowly over a tenth of its
// frequency. The effects' visibility is what it was: they are slower, and a fit that knows the motion's
// spectrum loses next to nothing.
const std::vector<std::string>& structures();

// The captures with the motion added to their rates; the same arguments give the same motion. Throws
// std::invalid_argument for an unknown structure.
std::vector<Capture> standing_on(const std::string& structure, const Sensor& sensor,
                                 std::vector<Capture> captures);

// `inner` with every capture that it is given moved so.
Diagnose moved_by(const std::string& structure, const Sensor& sensor, Diagnose inner);

}  // namespace ifog::undeclared
