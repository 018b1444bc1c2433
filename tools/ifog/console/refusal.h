// SPDX-License-Identifier: Apache-2.0
// The error with which a command ends: one line that names the file, the value and what was expected.
#pragma once

#include <fmt/core.h>

#include <stdexcept>
#include <utility>

namespace ifog::tools {

template <typename... Values>
std::runtime_error refusal(fmt::format_string<Values...> format, Values&&... values) {
  return std::runtime_error(fmt::format(format, std::forward<Values>(values)...));
}

}  // namespace ifog::tools
