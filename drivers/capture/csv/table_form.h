// SPDX-License-Identifier: Apache-2.0
// Where in a text its table begins, and how it is written: lines of other text above, what stands between the cells,
// the header or none, a row of units.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/capture/columns/column_roles.h"

namespace ifog {

struct TableForm {
  char separator = ',';
  std::size_t header_line = 0;  // its number, from 1; 0 where there is none
  std::size_t last_line = 0;    // the line above the first row: the header, or the row of units below it
  TableSample sample;           // names, units, the first rows, what stands above
};

// text: the file's beginning, whole lines. Throws std::runtime_error with one line: PATH, what was looked
// for. A header that begins with time_s is that of a capture, and the first such line is it; so is the first
// line that has all the names which the layout asks for. Else the header is the line above the first rows of
// as many cells, mostly numbers.
// given: the names of the columns where the lines themselves have them; then there is no header.
TableForm table_form(std::string_view text, const std::vector<std::string>& given, const std::string& path,
                     const CsvLayout& layout);

}  // namespace ifog
