// SPDX-License-Identifier: Apache-2.0
// Lines and cells of a text, and the first row of a table among them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ifog {

// Returns one line at a time, without its end.
class Lines {
 public:
  // before: number of lines before this text.
  explicit Lines(std::string_view text, std::size_t before = 0) : rest_(text), number_(before) {}
  bool next(std::string_view& line);
  [[nodiscard]] std::size_t number() const { return number_; }
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::size_t number_;
};

// All terminated lines of a text, without their ends.
[[nodiscard]] std::vector<std::string> lines_of(std::string_view text);
[[nodiscard]] std::string_view trimmed(std::string_view cell);
[[nodiscard]] std::string_view unquoted(std::string_view cell);
// End of the first cell: a separator outside quotes, or the row's end.
[[nodiscard]] std::size_t cell_end(std::string_view row, char separator);
// Cells of a line, without surrounding blanks and quotes; doubled quotes are one. Several blanks are one separator.
[[nodiscard]] std::vector<std::string> cells_of(std::string_view line, char separator);
// A name as one cell of a comma-separated header, in quotes if it needs them (RFC 4180).
[[nodiscard]] std::string as_cell(const std::string& text);

// Removes a comment mark: "#", "%", "//".
[[nodiscard]] std::string_view without_mark(std::string_view line);
[[nodiscard]] inline bool is_comment(std::string_view line) { return trimmed(line).starts_with('#'); }
[[nodiscard]] inline std::string_view text_of_comment(std::string_view line) {
  return trimmed(trimmed(line).substr(1));
}
// Bytes of comments that are kept, because a file may consist of them.
inline constexpr std::size_t kMostComments = std::size_t{1} << 20U;
// Missing values of R, pandas, databases, spreadsheets, and "-1.#IND" of Microsoft's C library.
[[nodiscard]] bool is_no_number(std::string_view cell);
// True for a number or date in the notation that goes with the separator.
[[nodiscard]] bool is_value(std::string_view cell, char separator);

struct Line {
  std::string_view text;
  std::size_t number = 0;
};

// A line split by one separator; a comment has no cells.
struct Row {
  std::vector<std::string> cells;
  std::size_t values = 0, empty = 0;
  bool open = false;  // ends with a separator: has one more, empty cell, or each row ends so
  bool comment = false;

  [[nodiscard]] bool is_as_wide(std::size_t other) const {
    return other == cells.size() || (open && other == cells.size() + 1);
  }
  // At least half of the non-empty cells are values; names of frames or modes are allowed.
  [[nodiscard]] bool is_row() const { return !comment && values > 0 && 2 * values >= cells.size() - empty; }
};

// The first lines of a text, split by one separator.
class Grid {
 public:
  static constexpr std::size_t kSampleRows = 64;

  Grid(const std::vector<Line>& lines, char separator);
  // Uses the separator with the largest share of values in the rows; among equals the one with most cells;
  // the comma if no line has two cells.
  static Grid of(const std::vector<Line>& lines);

  [[nodiscard]] char separator() const { return separator_; }
  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  // Index of the table's first row; nullopt if there is none.
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
