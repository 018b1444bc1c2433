// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace ifog::tools {

// "rate_x_radps" → signal "rate", axis "x"; of a denoised file "raw_x_radps" and so on.
// False for another column.
bool signal_of(const std::string& column, std::string& signal, std::string& axis);

}  // namespace ifog::tools
