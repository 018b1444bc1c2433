// SPDX-License-Identifier: Apache-2.0
// Names of a capture's columns, what their values may be, and message format for columns.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/capture/columns/csv_layout.h"

namespace ifog {

// "rate_x" of "rate" and the axis "x"; "rate" if the axis has no name.
inline std::string of_axis(const std::string& what, const std::string& axis) {
  return axis.empty() ? what : what + "_" + axis;
}

// Axis of a rate column: "" for "rate_radps", "x" for "rate_x_radps". False for other columns.
bool axis_of(const std::string& name, std::string_view prefix, std::string& axis);

// A rate or reference rate of any axis.
bool is_rate_column(const std::string& name);

// A rate of the sensor that the user did not choose: other_rate_y_radps. Used to detect rest.
bool is_other_rate(const std::string& name);

// Output of `ifog denoise`: raw_radps, compensated_x_radps, denoised_x_radps.
bool is_signal_column(const std::string& name);

// "'a', 'b'", for messages.
std::string listed(const std::vector<std::string>& names);
// Message for columns of which none is a rate.
std::string no_rate_among(const std::vector<std::string>& names);

// Shortest text that reads back exactly.
std::string shortest(double value);
void append_shortest(std::string& out, double value);

// Possible range of values. Values outside are no measurements, and a single one would dominate a fit. All commands
// use these ranges.
struct Measurable {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool holds(double value) const { return value >= least && value <= most; }
};

// A column of a file, except the time.
struct FileColumn : CsvColumn {
  std::string cell;       // its name in the file
  std::size_t place = 0;  // index of its cell in a row
  Measurable range;       // in the file's unit
};

// Range in the unit of the column's name: rates as in the driver interface, channels by their unit (no
// temperature below absolute zero, no field above 100 T), others as in the driver interface.
Measurable measurable(const std::string& column);

// The same for a column of a file, in the file's unit. Angles have a wide range.
Measurable measurable_in_file(const CsvColumn& column);
Measurable measurable_in_file(const CsvTime& time);

// Removes units in which no sensor measures one of the values, unless that leaves none. range_in: of a unit.
template <typename RangeIn>
void keep_measurable(std::vector<std::string>& units, const std::vector<double>& values, RangeIn range_in) {
  std::vector<std::string> possible = units;
  std::erase_if(possible, [&](const std::string& unit) {
    const Measurable range = range_in(unit);
    return !std::ranges::all_of(values, [&](double value) { return range.holds(value); });
  });
  if (!possible.empty()) units = std::move(possible);
}

}  // namespace ifog
