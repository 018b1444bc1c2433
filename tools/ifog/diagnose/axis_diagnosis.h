// SPDX-License-Identifier: Apache-2.0
// The diagnosis of an axis, as JSON and as text.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "filters/diagnosis/diagnose.h"

namespace ifog::tools {

struct AxisDiagnosis {
  std::string axis;  // "" for a single-axis sensor
  Diagnosis diagnosis;
};

// Schema ifog.diagnosis/1. One axis: the keys of the schema at the top level. Several axes: effects, alternatives and noise of all
// axes have an "axis", and the figures are objects by axis.
nlohmann::ordered_json diagnosis_json(const std::vector<AxisDiagnosis>& axes);

// For the console.
std::string diagnosis_text(const AxisDiagnosis& axis);

}  // namespace ifog::tools
