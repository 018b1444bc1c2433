// SPDX-License-Identifier: Apache-2.0
// A diagnosis as text for the console.
#pragma once

#include <string>

#include "tools/ifog/diagnose/diagnosis_json.h"

namespace ifog::tools {

std::string diagnosis_text(const AxisDiagnosis& axis);

}  // namespace ifog::tools
