// SPDX-License-Identifier: Apache-2.0
// The best possible diagnosis: it knows names, shapes and the true noise, and estimates only the sizes by
// generalised least squares. Its score is the limit of the captures, and tests the scoring.
#pragma once

#include "tests/bench/undeclared/scoring.h"

namespace ifog::undeclared {

Diagnose oracle_diagnosis(const Sensor& sensor);

// Never finds anything.
Diagnose blind_diagnosis();

}  // namespace ifog::undeclared
