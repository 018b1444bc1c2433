// SPDX-License-Identifier: Apache-2.0
// Role of each column of a text table, as chosen by the user or by its name.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/csv/table_form.h"

namespace ifog {

struct CsvHeader : TableForm {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  std::vector<std::string> cells;   // names of a row's cells in the file
  std::vector<FileColumn> columns;  // of the capture, without the time
  std::size_t time_place = kNone;   // cell of the time; kNone if rows are equidistant
  std::size_t time_part = kNone;    // second cell of the time: decimal digits or a time of day
  std::optional<int> part_digits;   // of that cell, if any; 0: a time of day
  DateOrder date_order = DateOrder::either;
  std::vector<bool> is_clock;        // by cell: a time or counter, which increases where the rest repeats
  std::size_t only_place = kNone;    // cell that decides whether a row is read
  std::vector<std::string> notices;  // how a foreign header was read, and which rows
};

// text: whole lines from the file's beginning, with at least the first rows. Throws std::runtime_error with
// one line: no time, a duplicate name, a missing column, or an ambiguity with the options that resolve it.
// given: names from the lines themselves, if any. has_lines: messages contain line numbers.
CsvHeader read_csv_header(std::string_view text, const std::vector<std::string>& given,
                          const std::string& path, const CsvLayout& layout, bool has_lines);

}  // namespace ifog
