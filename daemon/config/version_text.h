// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace ifog {

// Text of --version for reports: versions of the program and its interfaces, compiler and platform.
std::string version_text(const std::string& program);

}  // namespace ifog
