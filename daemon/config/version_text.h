// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace ifog {

// What --version says, as it wants to be in a question or a report of a fault: the program's version, those
// of what it exchanges with others, and what it was built by and for.
std::string version_text(const std::string& program);

}  // namespace ifog
