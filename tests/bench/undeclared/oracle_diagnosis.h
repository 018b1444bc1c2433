// SPDX-License-Identifier: Apache-2.0
// The best that any diagnosis could do: given the names, the shapes and the true noise, it estimates only the
// sizes, by generalised least squares. What it scores is what the captures allow; and it shows the scoring
// itself to be right.
#pragma once

#include "tests/bench/undeclared/scoring.h"

namespace ifog::undeclared {

Diagnose oracle_diagnosis(const Sensor& sensor);

// Finds nothing, ever: the floor.
Diagnose blind_diagnosis();

}  // namespace ifog::undeclared
