// SPDX-License-Identifier: Apache-2.0
// Errors of a command that have an exit code of their own.
#pragma once

#include <stdexcept>
#include <string>

namespace ifog::tools {

// A command line that is well formed but not valid: exit code 2.
struct WrongUsage : std::runtime_error {
  // The option or file, and its error: "is 'VALUE', expected EXPECTED".
  WrongUsage(const std::string& what, const std::string& complaint)
      : std::runtime_error(what + ": " + complaint) {}
};

// Thrown by a command that has printed its error: exit code 1, no further message.
struct Failed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace ifog::tools
