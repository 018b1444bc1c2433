// SPDX-License-Identifier: Apache-2.0
// What a part refuses, as one line that names the file it is of.
#pragma once

#include <stdexcept>
#include <string>

namespace ifog::tools {

// work(), whose std::runtime_error and std::invalid_argument become a std::runtime_error with `name` in front, unless it
// stands there already.
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
