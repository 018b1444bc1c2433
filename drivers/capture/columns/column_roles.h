// SPDX-License-Identifier: Apache-2.0
// Roles of a foreign table's columns, by names, units and first values. The same rules are used for reading
// and for suggestions. Second part: which column is the time and its unit, and what first values show:
// gravity, counts, an angle.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/capture/columns/csv_layout.h"
#include "drivers/capture/times/date_time.h"

namespace ifog {

// Beginning of a table.
struct TableSample {
  std::vector<std::string> names;               // of the columns; "#1", "#2", … without a header
  std::vector<std::vector<std::string>> cells;  // by column: the first rows
  std::vector<std::string> units;               // by column, from a row below the names; empty without one
  std::vector<std::string> comments;            // lines above the header, which may contain the sample rate
  bool named = true;

  // Column as written in options: by its number if its name is ambiguous or cannot be typed.
  [[nodiscard]] std::string header_of(std::size_t place) const;
  // Unit from the row of units, or "".
  [[nodiscard]] std::string stated_unit(std::size_t place) const { return units.empty() ? "" : units[place]; }
  // The same, or else from the name, or "".
  [[nodiscard]] std::string unit_of(std::size_t place) const;
};

// One way to read the table.
struct TableReading {
  CsvLayout layout;
  bool clear = true;    // nothing is ambiguous
  std::string options;  // as typed by a user; HZ for an unknown sample rate
};

struct Readings {
  std::vector<TableReading> ways;  // empty: nothing looks like a gyro; several: ambiguous
  std::string other_units;         // alternatives to the units in the options; "" if the units are known
  std::string why;                 // if options are needed: what is missing or ambiguous

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

// "time 'Time (s)' in s, rate_x 'Gyroscope X (deg/s)' in deg/s": how a file is read.
std::string in_words(const CsvLayout& layout);

// Unit in ASCII: deg/s for a degree sign of another encoding than UTF-8.
std::string typed(const std::string& unit);

// A column that counts rows ("Sample No.") and is no time, or "".
std::string counting_column(const TableSample& table);

inline constexpr std::size_t kFewRows = 8;  // too few to judge a column

// True for numbers that are not all equal.
bool varies(const std::vector<std::string>& cells);
// The finite numbers among the cells.
std::vector<double> numbers_in(const std::vector<std::string>& cells);
// True for integers with several values.
bool is_whole(const std::vector<std::string>& cells);

// Decimal digits of the integer in the second column of "sec+nsec": 9 for nanoseconds, by name or values; 0
// for a date and a time of day.
int digits_of_second(const std::string& name, const std::vector<std::string>& cells);

// Notice about a time column of integers: steps of one are a count of rows, unless a unit is given; larger
// steps are more likely milliseconds than seconds. The reading is not changed. "" if there is none.
std::string whole_times_notice(const TableSample& table, std::size_t place, const CsvTime& time);

// Order of dates like 05/06/2023, determined by a day above 12; nullopt if ambiguous; `either` for other
// times.
std::optional<DateOrder> date_order(const std::vector<std::string>& cells);

// Sample rate stated above the table: "Output Rate,200.0"; nullopt if none.
std::optional<double> stated_rate_hz(const std::vector<std::string>& comments);

// Scale and unit of a gyro's counts stated above the table: "gscale,0.00122" (gcsv of Gyroflow),
// "Gyro_SF=0.0151515" (Epson's logger). Empty unit if none.
CsvColumn stated_scale(const std::vector<std::string>& comments);

// A possible rate column.
struct RateCandidate {
  std::size_t place = 0;
  std::string unit{};  // "" if unknown
  std::string axis;
  std::vector<std::string> units{};  // possible ones, most likely first, if its name leaves some
  double scale = 1.0;                // of counts
  bool reference = false, increment = false;
};

using Rates = std::vector<RateCandidate>;

// Possible time columns of rows with these rates; a single one if it is most likely. Unknown units are empty.
std::vector<CsvTime> times_of(const TableSample& table, const Rates& rates);

// True if all cells are empty.
bool is_empty(const std::vector<std::string>& cells);
// True if some cells are numbers, and the others are empty.
bool are_numbers(const std::vector<std::string>& cells);

// True if three columns together have the length of gravity, i.e. are an accelerometer at rest: in m/s², g,
// mg or 16-bit counts with a range of 2, 4, 8 or 16 g.
bool is_gravity(const TableSample& table, const Rates& columns);

// Integers, as from a converter.
bool are_counts(const TableSample& table, const Rates& rates);

// Possible units of a rate or time column without a stated unit, most likely first.
std::vector<std::string> units_of(const TableSample& table, const Rates& rates);
std::vector<std::string> units_of(const TableSample& table, const CsvTime& time);

// Rates among columns without names: a single numeric column, or three adjacent ones as axes.
std::vector<Rates> rates_by_place(const TableSample& table, const std::optional<CsvTime>& time);

// Lower case.
[[nodiscard]] std::string lower(std::string text);

// Roles of a word in a column name; see column_words.cpp.
enum class Role { rate, speed, turn, glued, no_rate, truth, step, angle, time, no_time, ms, us, ns, s, one };
[[nodiscard]] bool says(std::string_view word, Role role);

// Parsed column name: "w_RS_S_x [rad s^-1]" has the words w, rs and s and the axis x.
struct Words {
  explicit Words(const std::string& header);

  std::vector<std::string> words;  // lower case, without axis, unit and index
  std::string axis;                // "x", "y", "z", or ""
  std::string stem;                // words separated by blanks: equal for all axes of a sensor
  std::string text;                // the name without its unit, as letters, digits and "_"

  [[nodiscard]] bool has(std::string_view word) const;
  [[nodiscard]] bool have(Role role) const;  // at least one word has the role
  [[nodiscard]] std::string_view first() const { return words.empty() ? std::string_view() : words.front(); }
  [[nodiscard]] std::size_t size() const { return words.size(); }
};

}  // namespace ifog
