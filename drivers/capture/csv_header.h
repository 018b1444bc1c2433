// SPDX-License-Identifier: Apache-2.0
// The header of a CSV file: what each of its columns is to a capture.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/capture/csv_layout.h"
#include "drivers/capture/measurable.h"

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

// What the cells below one name of the header mean.
struct CsvCell {
  static constexpr std::size_t kPassedOver = std::numeric_limits<std::size_t>::max();
  static constexpr std::size_t kTime = kPassedOver - 1;

  std::string name;                  // in the file
  Measurable range;                  // in the file's unit
  bool rate = false;                 // of the capture: a rate or its reference
  std::size_t column = kPassedOver;  // of the capture, beside the time
  bool kept = true;                  // else it is checked only
};

struct CsvHeader {
  std::vector<CsvCell> cells;            // in the file's order
  std::vector<std::string> names;        // of the capture's columns beside the time
  std::string comments;                  // that stood before it, as in RowNotes
  std::size_t line = 0, time_place = 0;  // its number; which cell is the time
  std::size_t last_line = 0;             // of a row of units below it, else its own
};

// The first line that is neither empty nor a comment; `lines` goes on behind it. False where there is none in
// this text. Throws std::runtime_error with one line: no time, a name twice, a column that is not there.
bool read_csv_header(Lines& lines, const std::string& path, const CsvLayout& layout, CsvHeader& header);

}  // namespace ifog
