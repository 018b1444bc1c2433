// SPDX-License-Identifier: Apache-2.0
// A capture in blocks of rows: readers pass them to a sink, so no command needs the whole capture in memory.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/capture/times/time_stamps.h"
#include "drivers/row_times/median.h"

namespace ifog {

// Value of a column without data in a row.
inline constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

// Median step of times; kMissing without steps.
[[nodiscard]] double median_step_s(const std::vector<double>& time_s);

// One faulty row in so many may come from a serial line, a full disk or a set clock; more mean a wrong table.
inline constexpr std::size_t kRowsAFault = 100;

// Cells, rows or lines with the same fault.
struct Fault {
  std::size_t count = 0;
  std::size_t line = 0;  // of the first one
  std::string first;     // content of the cell, or the error

  void add(std::size_t at, std::string what) {
    if (count++ == 0) line = at, first = std::move(what);
  }
  // Adds faults of a piece that starts after `lines` lines.
  void append(const Fault& piece, std::size_t lines) {
    if (count == 0) line = lines + piece.line, first = piece.first;
    count += piece.count;
  }
};

// Consecutive rows, by column.
struct RowBlock {
  std::vector<double> time_s;  // strictly increasing, also between blocks; never NaN
  // In the order of the names, each as long as time_s.
  std::vector<std::vector<double>> columns;
  TimeOrigin origin{};               // origin of time_s, equal in all blocks
  std::vector<std::size_t> lines{};  // of each row in its text; empty without lines
  std::vector<std::size_t> cells{};  // hash of each row's text but for clocks; empty without lines

  [[nodiscard]] std::size_t size() const { return time_s.size(); }
  // Appends rows; `rows` has unspecified values afterwards.
  void append(RowBlock& rows);
  // Moves a row to an earlier index.
  void move_row(std::size_t from, std::size_t to);
  void keep_first(std::size_t rows);
  // Moves the rows from `from` on into `to`, replacing its content.
  void split_off(std::size_t from, RowBlock& to);
};

class RowSink {
 public:
  virtual ~RowSink() = default;
  // Called once before the first rows: the columns without the time, as in a capture's header (rate_x_radps,
  // …).
  virtual void begin(const std::vector<std::string>& names) = 0;
  // Takes the next rows, at least one; may move or change them.
  virtual void take(RowBlock& rows) = 0;
};

// Passes single rows to a sink in blocks.
class RowBatch {
 public:
  static constexpr std::size_t kRows = std::size_t{1} << 14U;  // of a block
  explicit RowBatch(RowSink& sink) : sink_(sink) {}

  [[nodiscard]] bool begun() const { return !rows_.columns.empty(); }
  void begin(const std::vector<std::string>& names);
  void add(double time_s, std::span<const double> values, const TimeOrigin& origin = {});
  void hand_on();

 private:
  RowSink& sink_;
  RowBlock rows_;
};

// "PATH:LINE: WHAT"; without LINE if it is 0.
[[nodiscard]] std::string at_line(const std::string& path, std::size_t line, const std::string& what);
// Throws std::runtime_error with that line.
[[noreturn]] void fail_at(const std::string& path, std::size_t line, const std::string& what);

// Reports of a reader besides the rows; complete after the last row.
struct RowNotes {
  // Rows from `row` on are on consecutive lines from `line` on.
  struct Lines {
    std::size_t row, line;
  };

  std::string path;                        // of the file, for messages
  std::string comments;                    // without the '#', each with a line end
  std::size_t header_line = 0;             // 0: not from a text
  std::vector<Lines> lines;                // empty: rows have no lines; rows of HDF5 count from 1
  std::vector<std::string> notices;        // about ambiguous content
  std::vector<std::string> faults;         // cells read as missing, one line per column
  std::optional<double> since_power_up_s;  // of the sensor at the first row, if known

  void notice(std::size_t line, const std::string& what) { notices.push_back(at_line(path, line, what)); }
  void fault(std::size_t line, const std::string& what) { faults.push_back(at_line(path, line, what)); }
  // Of dropped lines or rows: "FIRST; 3 such rows are dropped"; kind: "row".
  void dropped(const Fault& found, const std::string& kind);
  [[noreturn]] void refuse(std::size_t line, const std::string& what) const { fail_at(path, line, what); }

  // Line of a data row (counted from 0), for messages; 0 without lines.
  [[nodiscard]] std::size_t line_of_row(std::size_t row) const;
  // Adds the lines of a block that starts at row `rows`.
  void add_lines(std::size_t rows, const RowBlock& block);
};

}  // namespace ifog
