// SPDX-License-Identifier: Apache-2.0
// How a foreign table can be read: its rates, its time and their units, by names, units and first values
// together. The same rules are used for reading and for suggestions.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/capture/columns/column.h"
#include "drivers/capture/columns/csv_layout.h"
#include "drivers/capture/times/date_time.h"

namespace ifog {

// One way to read the table.
struct TableReading {
  CsvLayout layout;
  bool clear = true;    // nothing is ambiguous
  std::string options;  // as typed by a user; HZ for an unknown sample rate
};

struct Readings {
  std::vector<TableReading> ways{};  // empty: nothing looks like a gyro; several: ambiguous
  std::string other_units{};         // alternatives to the units in the options; "" if the units are known
  std::string why{};                 // if options are needed: what is missing or ambiguous

  // The unambiguous reading, or null.
  [[nodiscard]] const TableReading* clear() const {
    return ways.size() == 1 && ways[0].clear ? &ways[0] : nullptr;
  }
};

// asked: the user's choice; only the rest is determined.
Readings readings_of(const TableSample& table, const CsvLayout& asked);

// The sensor's rates not in `chosen`, as other_rate_y_radps in the same unit: rotation of one axis moves the
// others. Empty if the names do not identify them.
std::vector<CsvColumn> rates_not_chosen(const TableSample& table, const CsvLayout& chosen);

// Time in which the increments of a layout turned, where a column says it ("dt_us", "delta_angle_dt") and the rows are not
// closer, as interval_s; nullopt: they are of the time between rows.
std::optional<CsvColumn> interval_of(const TableSample& table, const CsvLayout& layout);

// "time 'Time (s)' in s, rate_x 'Gyroscope X (deg/s)' in deg/s": how a file is read.
std::string in_words(const CsvLayout& layout);

// A column that may be a rate.
struct RateCandidate {
  std::size_t place = 0;
  std::string axis{};
  // Possible ones, most likely first; one: known; none: the name leaves all.
  std::vector<std::string> units{};
  double scale = 1.0;  // of counts
  bool reference = false, increment = false, angle = false;
};
using Rates = std::vector<RateCandidate>;  // of one sensor, by axis

// Each sensor of which these may be the rates; time: of a table without names. references: true rates instead.
std::vector<Rates> sensors_of(const TableSample& table, const std::optional<CsvTime>& time,
                              bool references = false);
// Sets the units that names leave open by the scale stated above the table, or by what a sensor may measure.
void settle_units(const TableSample& table, Rates& rates);

// A column, or two, that may be the time.
struct TimeCandidate {
  CsvTime time;
  std::vector<std::string> units;  // as of a rate, at least one
};
// Possible times of rows with these rates; a single one if it is most likely.
std::vector<TimeCandidate> times_of(const TableSample& table, const Rates& rates);

// Decimal digits of the integer in the second column of "sec+nsec": 9 for nanoseconds, by name or values; 0
// for a date and a time of day.
int digits_of_second(const TableColumn& part);

// Notice about a time column of integers: steps of one are a count of rows, unless a unit is given; larger
// steps are more likely milliseconds than seconds. The reading is not changed. "" if there is none.
std::string whole_times_notice(const TableColumn& column, const CsvTime& time);

// Order of dates like 05/06/2023, determined by a day above 12; nullopt if ambiguous; `either` for other
// times.
std::optional<DateOrder> date_order(const std::vector<std::string>& cells);

// Sample rate stated above the table: "Output Rate,200.0"; nullopt if none.
std::optional<double> stated_rate_hz(const std::vector<std::string>& comments);
// Number after one of these names, written without blanks, in a line above the table.
std::optional<double> stated(const std::vector<std::string>& comments,
                             std::initializer_list<std::string_view> names);

}  // namespace ifog
