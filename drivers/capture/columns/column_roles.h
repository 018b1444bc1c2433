// SPDX-License-Identifier: Apache-2.0
// What the columns of a foreign table are to a capture, by their names, units and first values. The same
// rules make the reading and the suggestion, so that what is suggested is what reads the file. Below: which column is
// the time, and in what unit; and what the first values tell where a name does not: gravity, counts, an angle.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/capture/columns/csv_layout.h"
#include "drivers/capture/times/date_time.h"

namespace ifog {

// A table's beginning.
struct TableSample {
  std::vector<std::string> names;               // of the columns; "#1", "#2", … where no header names them
  std::vector<std::vector<std::string>> cells;  // by column: those of the first rows
  std::vector<std::string> units;     // of each, by a row below the names; empty where there is none
  std::vector<std::string> comments;  // lines above the header, which may state the sample rate
  bool named = true;

  // A column as the options name it: by its number where others have its name, or it has none that can be typed.
  [[nodiscard]] std::string header_of(std::size_t place) const;
  // What the row of units says of a column; "" for nothing.
  [[nodiscard]] std::string stated_unit(std::size_t place) const { return units.empty() ? "" : units[place]; }
};

// One way to read the table.
struct TableReading {
  CsvLayout layout;
  bool clear = true;    // nothing is left for the user to say
  std::string options;  // as a user types it; HZ stands for a sample rate that nothing states
};

struct Readings {
  std::vector<TableReading> ways;  // empty: nothing looks like a gyro; several: all that the names allow
  std::string other_units;  // that may stand in the place of those in the options; "" where they are known
  std::string why;          // of a table that is not read without options: what is missing or ambiguous

  // The one reading that needs no question, or null.
  [[nodiscard]] const TableReading* clear() const {
    return ways.size() == 1 && ways[0].clear ? &ways[0] : nullptr;
  }
};

// asked: what the user chose already; only the rest is looked for.
Readings readings_of(const TableSample& table, const CsvLayout& asked);

// The sensor's rates that `chosen` leaves out, as other_rate_y_radps in the unit of the chosen ones: what
// turns one axis moves the others. Empty where the names do not say which they are.
std::vector<CsvColumn> rates_not_chosen(const TableSample& table, const CsvLayout& chosen);

// "time 'Time (s)' in s, rate_x 'Gyroscope X (deg/s)' in deg/s", for the line that says how a file is read.
std::string in_words(const CsvLayout& layout);

// The columns that the time may be, most likely alone: one, where one is more likely than all others. Without a unit
// where neither name nor values tell it.
std::vector<CsvTime> times_of(const TableSample& table);

// A unit in letters that can be typed: deg/s for a degree sign of another encoding than UTF-8.
std::string typed(const std::string& unit);

// A column of whole numbers one apart, which no time is: "Sample No."; "" where there is none.
std::string counting_column(const TableSample& table);

// Not the same in all of these rows, and numbers.
bool varies(const std::vector<std::string>& cells);
// Goes from row to row by little of what it has come through, as an angle does and white noise does not.
bool is_smooth(const std::vector<std::string>& cells);
// Whole numbers, of several values.
bool is_whole(const std::vector<std::string>& cells);

// Digits behind the point that a whole number in the second column of "sec+nsec" stands for: 9 for
// nanoseconds, by its name or its values; 0 where the two are a date and a time of day.
int digits_of_second(const std::string& name, const std::vector<std::string>& cells);

// What to say of a time column of whole numbers: one apart they are a count of rows, unless their unit is given;
// further apart and without decimals they are more often milliseconds than samples of a second each. It is
// said, not changed. "" for nothing.
std::string whole_times_notice(const TableSample& table, std::size_t place, const CsvTime& time);

// The order of dates as 05/06/2023, which a day above 12 tells; nothing where it is unknown; either of all
// other times.
std::optional<DateOrder> date_order(const std::vector<std::string>& cells);

// A stated sample rate, as loggers write it above the table: "Output Rate,200.0"; nothing where none is.
std::optional<double> stated_rate_hz(const std::vector<std::string>& comments);

// What a gyro's count stands for, scale and unit, as loggers write it there: "gscale,0.00122" of the gcsv format of
// Gyroflow, "Gyro_SF=0.0151515" of Epson's logger. No unit where none does.
CsvColumn stated_scale(const std::vector<std::string>& comments);

// A column that may be a rate.
struct RateCandidate {
  std::size_t place = 0;
  std::string unit;  // "" where it is unknown
  std::string axis;
  double scale = 1.0;  // of counts
  bool reference = false, increment = false;
};

using Rates = std::vector<RateCandidate>;

// Three columns as long together as gravity are an accelerometer at rest: in m/s², g, mg or, of 16 bits and a
// range of 2, 4, 8 or 16 g, counts.
bool is_gravity(const TableSample& table, const Rates& columns);

// Whole numbers, as a converter counts.
bool are_counts(const TableSample& table, const Rates& rates);

// What a rate's column may hold where neither its name nor a row of units tells; the likeliest first.
std::vector<std::string> units_of(const TableSample& table, const Rates& rates);

// Columns that have no names, without those of the time: one of numbers is the rate, and three next to each
// other may be its axes.
std::vector<Rates> rates_by_place(const TableSample& table, const std::optional<CsvTime>& time);

// In small letters.
[[nodiscard]] std::string lower(std::string text);

// What a word says of a column; the words of each role, and what the role is, stand in column_words.cpp.
enum class Role { rate, speed, turn, glued, no_rate, truth, step, angle, time, no_time, ms, us, ns, s, one };
[[nodiscard]] bool says(std::string_view word, Role role);

// A column's name taken apart: "w_RS_S_x [rad s^-1]" is the words w, rs and s of axis x.
struct Words {
  explicit Words(const std::string& header);

  std::vector<std::string> words;  // in small letters, without the axis, the unit and an index
  std::string axis;                // "x", "y", "z"; "" where the name has none
  std::string stem;                // the words, a blank between them: the same for all axes of a sensor
  std::string text;  // the name without its unit, as a column's name may be: letters, digits, "_"

  [[nodiscard]] bool has(std::string_view word) const;
  [[nodiscard]] bool have(Role role) const;  // one of them at least
  [[nodiscard]] std::string_view first() const { return words.empty() ? std::string_view() : words.front(); }
  [[nodiscard]] std::size_t size() const { return words.size(); }
};

}  // namespace ifog
