// SPDX-License-Identifier: Apache-2.0
// Adds the name of a file to error messages.
#pragma once

#include <stdexcept>
#include <string>

namespace ifog::tools {

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
