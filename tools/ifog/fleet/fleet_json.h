// SPDX-License-Identifier: Apache-2.0
// A population as JSON, schema ifog.fleet/1.
#pragma once

#include <nlohmann/json.hpp>

#include "filters/population/population.h"

namespace ifog::tools {

nlohmann::ordered_json fleet_json(const Population& population);

}  // namespace ifog::tools
