// SPDX-License-Identifier: Apache-2.0
// What each column of a table of text is to a capture: as the user chose, or as its names say.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/capture/columns/csv_layout.h"
#include "drivers/capture/columns/measurable.h"
#include "drivers/capture/times/date_time.h"

namespace ifog {

struct CsvHeader {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  std::vector<std::string> cells;   // of a row: their names in the file
  std::vector<std::string> names;   // of the capture's columns without the time
  std::vector<FileColumn> columns;  // of each, where it is from
  CsvLayout layout;                 // that reads it
  char separator = ',';
  std::string comments;            // that stood before it, as in RowNotes
  std::size_t last_line = 0;       // number of the line above the first row
  std::size_t time_place = kNone;  // which cell is the time; kNone where rows are even
  std::size_t time_part = kNone;   // a second cell of the time: digits behind the point, or a time of day
  std::optional<int> part_digits;  // of it, if there is one; 0: a time of day
  DateOrder date_order = DateOrder::either;
  std::size_t only_place = kNone;    // which cell says whether a row is read
  std::vector<std::string> notices;  // how a foreign header was read, and what rows are in turn
};

// text: whole lines, the file's beginning with at least its first rows. Throws std::runtime_error with one
// line: no time, a name twice, a column that is not there, what is ambiguous, with the options that read it.
// given: names that the lines themselves have, where they do. has_lines: a message says in which.
CsvHeader read_csv_header(std::string_view text, const std::vector<std::string>& given,
                          const std::string& path, const CsvLayout& layout, bool has_lines);

}  // namespace ifog
