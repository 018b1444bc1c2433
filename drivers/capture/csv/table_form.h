// SPDX-License-Identifier: Apache-2.0
// Position and form of the table in a text: preamble, separator, header, row of units.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/capture/columns/readings.h"

namespace ifog {

struct TableForm {
  char separator = ',';
  Notation notation;
  std::size_t header_line = 0;   // from 1; 0 without a header
  std::size_t last_line = 0;     // last line before the first row: header or row of units
  CsvLayout layout;              // as given, with the kind of rows in a log of several kinds without a header
  std::size_t unused_names = 0;  // in the header, if rows have another number of cells; else 0
  TableSample sample;            // names, units, first rows, preamble
};

// text: whole lines from the file's beginning. The header is the first line that starts with time_s, or that
// has all names in the layout; else the line above the first rows of equally many, mostly numeric cells.
// given: column names from the lines themselves; then there is no header. Throws std::runtime_error with one
// line: PATH, what was expected.
TableForm table_form(std::string_view text, const std::vector<std::string>& given, const std::string& path,
                     const CsvLayout& layout);

}  // namespace ifog
