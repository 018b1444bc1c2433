// SPDX-License-Identifier: Apache-2.0
// Where in a text its table begins, and how it is written: lines of other text above, what stands between the
// cells, the header or none, a row of units.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/capture/columns/column_roles.h"
#include "drivers/capture/columns/csv_layout.h"

namespace ifog {

// Hands out one line at a time, without its end.
class Lines {
 public:
  // `before`: lines that stood in front of this text.
  explicit Lines(std::string_view text, std::size_t before = 0) : rest_(text), number_(before) {}
  bool next(std::string_view& line);
  [[nodiscard]] std::size_t number() const { return number_; }
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::size_t number_;
};

[[nodiscard]] std::string_view trimmed(std::string_view cell);
[[nodiscard]] std::string_view unquoted(std::string_view cell);
// Where the first cell of a row ends: at a separator outside of quotes, or with the row.
[[nodiscard]] std::size_t cell_end(std::string_view row, char separator);
// The cells of a line, without blanks and quotes around. Between blanks, several are one separator.
[[nodiscard]] std::vector<std::string> cells_of(std::string_view line, char separator);

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
