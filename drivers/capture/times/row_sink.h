// SPDX-License-Identifier: Apache-2.0
// A capture in blocks of rows: every reader passes them to a sink, so that no command has to hold the whole.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/capture/times/time_stamps.h"

namespace ifog {

// In a column: no value in this row.
inline constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

// Of at least one value.
[[nodiscard]] double median_value(std::vector<double> values);
// Of the steps between times; kMissing where there is none.
[[nodiscard]] double median_step_s(const std::vector<double>& time_s);

// One faulty row in so many is left to a serial line, a full disk or a clock that was set; more mean another table.
inline constexpr std::size_t kRowsAFault = 100;

// Cells, rows or lines of which one thing is wrong.
struct Fault {
  std::size_t count = 0;
  std::size_t line = 0;  // of the first
  std::string first;     // the cell as it stands there, or what is wrong

  void add(std::size_t at, std::string what) {
    if (count++ == 0) line = at, first = std::move(what);
  }
  // Those of a piece that `lines` others stand before.
  void append(const Fault& piece, std::size_t lines) {
    if (count == 0) line = lines + piece.line, first = piece.first;
    count += piece.count;
  }
  // "PATH:LINE: FIRST; 3 such rows are dropped"; kind: "row".
  [[nodiscard]] std::string dropped(const std::string& path, const std::string& kind) const {
    return path + ":" + std::to_string(line) + ": " + first + "; " +
           (count == 1 ? "this " + kind + " is" : std::to_string(count) + " such " + kind + "s are") +
           " dropped";
  }
};

// Rows that follow one another, by column.
struct RowBlock {
  std::vector<double> time_s;  // strictly increasing, within and from block to block; never NaN
  // In the order of the names, each as long as time_s; or empty, where the sink does not want it.
  std::vector<std::vector<double>> columns;
  TimeOrigin origin{};               // what time_s is counted from, the same in all blocks
  std::vector<std::size_t> lines{};  // of each row in its text; empty where rows have none

  [[nodiscard]] std::size_t size() const { return time_s.size(); }
  // Appends the rows that follow. `rows` has unspecified values afterwards.
  void append(RowBlock& rows);
  // Puts a row to where an earlier one was.
  void move_row(std::size_t from, std::size_t to);
  // Leaves so many.
  void keep_first(std::size_t rows);
  // Moves the rows from there on into `to`, in place of what it holds.
  void split_off(std::size_t from, RowBlock& to);
};

class RowSink {
 public:
  virtual ~RowSink() = default;
  // Once, before the first rows: the columns without the time, as in a capture's header (rate_x_radps, …).
  virtual void begin(const std::vector<std::string>& names) = 0;
  // After that: whether the sink needs the column. A column that it does not need is checked, too, and may be
  // empty.
  [[nodiscard]] virtual bool wants(std::size_t column) const {
    (void)column;
    return true;
  }
  // The next rows, at least one. The sink may move or change them.
  virtual void take(RowBlock& rows) = 0;
};

// What a reader reports besides the rows. Complete after the last row.
struct RowNotes {
  // Rows from this one on stand on lines that follow one another.
  struct Lines {
    std::size_t row, line;
  };

  std::string comments;              // without the '#', each with a line's end behind it
  std::size_t header_line = 0;       // 0: not read from a text
  std::vector<Lines> lines;          // empty: rows have no lines. Rows of HDF5 are counted from 1 instead
  std::vector<std::string> notices;  // of the reading: what may be meant otherwise
  std::vector<std::string> faults;   // cells read as missing, one line a column
  std::optional<double> since_power_up_s;  // of the sensor at the first row, where that is known

  // The line of a data row (counted from 0), for messages about its values; 0 where rows have none.
  [[nodiscard]] std::size_t line_of_row(std::size_t row) const;
  // Notes the lines of the rows that follow `rows` others.
  void add_lines(std::size_t rows, const RowBlock& block);
};

}  // namespace ifog
