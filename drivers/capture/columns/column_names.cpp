// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/columns/column_names.h"

#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "drivers/ifog/quoted.h"

namespace ifog {

bool axis_of(const std::string& name, std::string_view prefix, std::string& axis) {
  constexpr std::string_view kUnit = "_radps";
  if (!name.starts_with(prefix) || !name.ends_with(kUnit)) return false;
  if (name.size() == prefix.size() + kUnit.size()) {
    axis.clear();
    return true;
  }
  if (name.size() < prefix.size() + kUnit.size() + 2 || name[prefix.size()] != '_') return false;
  axis = name.substr(prefix.size() + 1, name.size() - prefix.size() - kUnit.size() - 1);
  return axis.find('_') == std::string::npos;  // rate_ramp_x_radps is a channel, not an axis
}

bool is_rate_column(const std::string& name) {
  std::string axis;
  return axis_of(name, "rate", axis) || axis_of(name, "reference_rate", axis);
}

bool is_other_rate(const std::string& name) {
  std::string axis;
  return axis_of(name, "other_rate", axis);
}

bool is_signal_column(const std::string& name) {
  std::string axis;
  return axis_of(name, "raw", axis) || axis_of(name, "compensated", axis) || axis_of(name, "denoised", axis);
}

std::string listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + in_quotes(name);
  return printable(list, kLongestMessage);
}

std::string no_rate_among(const std::vector<std::string>& names) {
  return "no rate column among " + listed(names) +
         ", expected 'rate_radps' or 'rate_x_radps', …, or --column rate_x_radps=NAME:UNIT with one of these "
         "names";
}

void append_shortest(std::string& out, double value) {
  std::array<char, 40> text{};  // suffices for any double
  const char* const end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  out += std::isnan(value) ? std::string_view("nan") : std::string_view(text.data(), end);
}

std::string shortest(double value) {
  std::string text;
  append_shortest(text, value);
  return text;
}

void fail_at(const std::string& path, std::size_t line, const std::string& what) {
  throw std::runtime_error(path + (line == 0 ? "" : ":" + std::to_string(line)) + ": " + what);
}

}  // namespace ifog
