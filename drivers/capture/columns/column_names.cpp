// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/columns/column_names.h"

#include <array>
#include <charconv>
#include <cmath>

#include "drivers/ifog/driver.h"
#include "drivers/ifog/quoted.h"
#include "drivers/units/units.h"

namespace ifog {
namespace {

// Until 2115, or ±145 years for other origins: differences in ns fit into 64 bits.
constexpr double kMostTime_s = 4.6e9;
constexpr double kMostAngle_rad = 1e9;  // beyond, float32 resolves only 64 rad

constexpr std::array<std::pair<std::string_view, Measurable>, 6> kUnits = {{
    {"degC", {-273.15, 3000.0}},  // absolute zero; pyrometer
    {"mps2", {-5e5, 5e5}},        // launch of a shell
    {"V", {-1e6, 1e6}},           // high-voltage lines
    {"A", {-1e6, 1e6}},           // lightning
    {"uT", {-1e8, 1e8}},          // strongest pulsed magnets
    {"Pa", {-1e7, 1e9}},          // difference of two; ten times the deepest sea
}};

// Range in the file's unit, before the conversion.
Measurable before(const Measurable& range, const UnitConversion& conversion) {
  const double a = (range.least - conversion.offset) / conversion.scale;
  const double b = (range.most - conversion.offset) / conversion.scale;
  return {std::min(a, b), std::max(a, b)};
}

}  // namespace

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

Measurable measurable(const std::string& column) {
  if (column == "time_s") return {-kMostTime_s, kMostTime_s};
  if (is_rate_column(column)) return {-IFOG_MAX_RATE, IFOG_MAX_RATE};
  const std::string unit = unit_in_name(column);
  for (const auto& [known, range] : kUnits)
    if (const auto to = convert_unit(known, unit))
      return {range.least * to->scale + to->offset, range.most * to->scale + to->offset};
  return {-IFOG_MAX_ENVIRONMENT_VALUE, IFOG_MAX_ENVIRONMENT_VALUE};
}

Measurable measurable_in_file(const CsvColumn& column) {
  const Measurable range =
      column.angle_rad() ? Measurable{-kMostAngle_rad, kMostAngle_rad} : measurable(column.name);
  return before(range, column.conversion());
}

Measurable measurable_in_file(const CsvTime& time) {
  return before(measurable("time_s"), {time.unit_s(), 0.0});
}

}  // namespace ifog
