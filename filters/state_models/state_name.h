// SPDX-License-Identifier: Apache-2.0
// Names of state models as people write them, apart from the models, which are mathematics.
#pragma once

#include <string>

namespace ifog {

// Whether it is one of state_model_names() or a sum of them with " + ", whatever its parameters.
bool is_state_model(const std::string& name);

}  // namespace ifog
