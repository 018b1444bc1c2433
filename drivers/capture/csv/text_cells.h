// SPDX-License-Identifier: Apache-2.0
// A text's lines and their cells, and where among them the rows of a table begin.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

// Each line of a text that ends with one, without its end.
[[nodiscard]] std::vector<std::string> lines_of(std::string_view text);
[[nodiscard]] std::string_view trimmed(std::string_view cell);
[[nodiscard]] std::string_view unquoted(std::string_view cell);
// Where the first cell of a row ends: at a separator outside of quotes, or with the row.
[[nodiscard]] std::size_t cell_end(std::string_view row, char separator);
// The cells of a line, without blanks and quotes around. Between blanks, several are one separator.
[[nodiscard]] std::vector<std::string> cells_of(std::string_view line, char separator);

// Without a comment's mark as loggers write it: "#", "%", "//".
[[nodiscard]] std::string_view without_mark(std::string_view line);
[[nodiscard]] inline bool is_comment(std::string_view line) { return trimmed(line).starts_with('#'); }
// A number or a date, as the cells between that separator write it.
[[nodiscard]] bool is_value(std::string_view cell, char separator);

struct Line {
  std::string_view text;
  std::size_t number = 0;
};

// A line between one separator.
struct Row {
  std::vector<std::string> cells;
  std::size_t values = 0, empty = 0;
  bool open = false;  // ends with a separator: of one cell more, which is empty, or as some writers end rows
  bool comment = false;

  [[nodiscard]] bool is_as_wide(std::size_t other) const {
    return other == cells.size() || (open && other == cells.size() + 1);
  }
  // Half of what is not empty at least: a name of a frame or a mode may stand among numbers.
  [[nodiscard]] bool is_row() const { return !comment && values > 0 && 2 * values >= cells.size() - empty; }
};

// The lines of a text's beginning between one separator.
class Grid {
 public:
  static constexpr std::size_t kSampleRows = 64;

  Grid(const std::vector<Line>& lines, char separator);
  // Between the separator by which most of what stands in the rows is values; of several the one by which there
  // are most cells; the comma where no line has two cells.
  static Grid of(const std::vector<Line>& lines);

  [[nodiscard]] char separator() const { return separator_; }
  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  // The first row of the table; nothing where there are no rows.
  [[nodiscard]] std::optional<std::size_t> first() const { return first_; }
  [[nodiscard]] std::size_t width() const { return first_ ? rows_[*first_].cells.size() : 0; }

 private:
  void find_first();
  [[nodiscard]] double share() const;

  char separator_;
  std::vector<Row> rows_;
  std::optional<std::size_t> first_;
};

}  // namespace ifog
