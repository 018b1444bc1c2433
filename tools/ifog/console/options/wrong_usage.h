// SPDX-License-Identifier: Apache-2.0
// A command line that is well formed but not valid: exit code 2.
#pragma once

#include <stdexcept>
#include <string>

namespace ifog::tools {

struct WrongUsage : std::runtime_error {
  // The option or file, and its error: "is 'VALUE', expected EXPECTED".
  WrongUsage(const std::string& what, const std::string& complaint)
      : std::runtime_error(what + ": " + complaint) {}
};

}  // namespace ifog::tools
