// SPDX-License-Identifier: Apache-2.0
// The names of a capture's columns, and how their faults are told.
#pragma once

#include <array>
#include <charconv>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/ifog/quoted.h"

namespace ifog {

// The axis of a rate column: "rate_radps" is "", "rate_x_radps" is "x". False: not such a column.
bool axis_of(const std::string& name, std::string_view prefix, std::string& axis);

// A rate or its reference, of any axis.
bool is_rate_column(const std::string& name);

// What `ifog denoise` writes: raw_radps, compensated_x_radps, denoised_x_radps.
bool is_signal_column(const std::string& name);

// Shortest text that reads back the same.
std::string shortest(double value);

// Throws std::runtime_error: "PATH:LINE: WHAT"; without the line where it is 0, as of a file that has none.
[[noreturn]] void fail_at(const std::string& path, std::size_t line, const std::string& what);
// Of a column that was chosen without a unit, whose own name says another than was wanted.
std::string unit_by_name(const std::string& header, const std::string& unit, const std::string& option);

inline bool axis_of(const std::string& name, std::string_view prefix, std::string& axis) {
  constexpr std::string_view kUnit = "_radps";
  if (!name.starts_with(prefix) || !name.ends_with(kUnit)) return false;
  if (name.size() == prefix.size() + kUnit.size()) {
    axis.clear();
    return true;
  }
  if (name.size() < prefix.size() + kUnit.size() + 2 || name[prefix.size()] != '_') return false;
  axis = name.substr(prefix.size() + 1, name.size() - prefix.size() - kUnit.size() - 1);
  return axis.find('_') == std::string::npos;  // rate_ramp_x_radps is somebody's channel, not an axis
}

inline bool is_rate_column(const std::string& name) {
  std::string axis;
  return axis_of(name, "rate", axis) || axis_of(name, "reference_rate", axis);
}

inline bool is_signal_column(const std::string& name) {
  std::string axis;
  return axis_of(name, "raw", axis) || axis_of(name, "compensated", axis) || axis_of(name, "denoised", axis);
}

inline std::string shortest(double value) {
  std::array<char, 40> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

inline void fail_at(const std::string& path, std::size_t line, const std::string& what) {
  throw std::runtime_error(path + (line == 0 ? "" : ":" + std::to_string(line)) + ": " + what);
}

inline std::string unit_by_name(const std::string& header, const std::string& unit,
                                const std::string& option) {
  return in_quotes(header) + " is in " + in_quotes(unit) +
         " by its name, and no unit was told; to read it so: " + option;
}

}  // namespace ifog
