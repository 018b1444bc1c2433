// SPDX-License-Identifier: Apache-2.0
// The error with which a command ends: one line that names the file, the value and what was expected.
#pragma once

#include <fmt/core.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace ifog::tools {

template <typename... Values>
std::runtime_error refusal(fmt::format_string<Values...> format, Values&&... values) {
  return std::runtime_error(fmt::format(format, std::forward<Values>(values)...));
}

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

// Calls work(); puts `name` in front of the message of a std::runtime_error or std::invalid_argument, unless
// it is there already.
template <typename Work>
auto naming(const std::string& name, const Work& work) {
  const auto named = [&name](const std::string& line) {
    return std::runtime_error(line.starts_with(name) ? line : name + ": " + line);
  };
  try {
    return work();
  } catch (const std::runtime_error& error) {
    throw named(error.what());
  } catch (const std::invalid_argument& error) {
    throw named(error.what());
  }
}

}  // namespace ifog::tools
