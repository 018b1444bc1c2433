// SPDX-License-Identifier: Apache-2.0
// A diagnosis as JSON, schema ifog.diagnosis/1.
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

// One axis: the keys of the schema at the top level. Several axes: effects, alternatives and noise of all
// axes have an "axis", and the figures are objects by axis.
nlohmann::ordered_json diagnosis_json(const std::vector<AxisDiagnosis>& axes);

}  // namespace ifog::tools
