// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/columns/measurable.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/ifog/driver.h"
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
