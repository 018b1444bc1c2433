// SPDX-License-Identifier: Apache-2.0
// Names of state models, without the models.
#pragma once

#include <string>

namespace ifog {

// True for one of state_model_names() or a sum of them with " + ", with any parameters.
bool is_state_model(const std::string& name);

}  // namespace ifog
