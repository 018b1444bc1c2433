// SPDX-License-Identifier: Apache-2.0
// What the columns of a foreign table are to a capture, by their names, units and first values. The same
// rules make the reading and the suggestion, so that what is suggested is what reads the file.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "drivers/capture/columns/csv_layout.h"

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

}  // namespace ifog
