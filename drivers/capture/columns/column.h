// SPDX-License-Identifier: Apache-2.0
// What is known of a table's column before its role is decided: the words of its name, its unit, and its first
// cells. All evidence is gathered once, here.
#pragma once

#include <cctype>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ifog {

[[nodiscard]] inline bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
[[nodiscard]] inline bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }
// Lower case.
[[nodiscard]] std::string lower(std::string text);
// True for UTF-8 without control characters.
[[nodiscard]] bool is_utf8(const std::string& text);
// The text, or Latin-1 in UTF-8, as a name is typed.
[[nodiscard]] std::string in_utf8(const std::string& text);

// Roles of a word in a column name; see column.cpp.
enum class Role { rate, speed, turn, glued, no_rate, truth, step, angle, time, no_time, one };
[[nodiscard]] bool says(std::string_view word, Role role);

// Parsed column name: "w_RS_S_x [rad s^-1]" has the words w, rs and s and the axis x.
struct Words {
  explicit Words(const std::string& header);

  std::vector<std::string> words;  // lower case, without axis, unit and index
  std::string axis;                // "x", "y", "z", or ""
  char number = '\0';              // at the end of the name, if any, which may count axes
  std::string stem;                // words separated by blanks: equal for all axes of a sensor
  std::string text;                // the name without its unit, as letters, digits and "_"

  [[nodiscard]] bool has(std::string_view word) const;
  [[nodiscard]] bool have(Role role) const;  // at least one word has the role
  [[nodiscard]] std::string_view first() const { return words.empty() ? std::string_view() : words.front(); }
  [[nodiscard]] std::size_t size() const { return words.size(); }
};

// "x", "y", "z" of 0, 1, 2.
[[nodiscard]] inline std::string axis_name(std::size_t i) { return {static_cast<char>('x' + i)}; }

inline constexpr std::size_t kFewRows = 8;  // too few to judge a column

struct TableColumn {
  // stated: unit from a row below the names, or "". cells: of the first rows.
  TableColumn(std::string name, const std::string& stated, std::vector<std::string> cells);
  void set_cells(std::vector<std::string> cells);

  std::string name;    // in the file; "#3" without a header
  std::string header;  // as typed in options: its number if its name is ambiguous or cannot be typed
  std::string stated;  // in ASCII
  std::string unit;    // the stated one, or that of the name, in ASCII, or ""
  Words words;
  std::vector<std::string> cells;
  std::vector<std::string> filled;  // without empty cells, i.e. rows of another sensor
  std::vector<double> values;       // the finite numbers among the cells

  [[nodiscard]] bool is_empty() const { return !cells.empty() && filled.empty(); }
  // Numbers, apart from empty cells.
  [[nodiscard]] bool is_numeric() const { return !values.empty() && values.size() == filled.size(); }
  [[nodiscard]] bool is_dates() const;
  // Numbers that are not all equal; also a single one.
  [[nodiscard]] bool varies() const;
  // Integers.
  [[nodiscard]] bool is_whole() const;
  // Integers, as from a converter or a counter: at least kFewRows, and several values.
  [[nodiscard]] bool are_counts() const { return values.size() >= kFewRows && varies() && is_whole(); }
  // Integers that increase by one, as a number of the row.
  [[nodiscard]] bool counts_rows() const;
  // Numbers, each larger than the one before, as of a clock or counter.
  [[nodiscard]] bool increases() const;
  // Little change from row to row compared with the range, as of an angle. Von Neumann's ratio: mean squared
  // difference / variance; 2 for white noise.
  [[nodiscard]] bool is_smooth() const;
};

// Beginning of a table.
struct TableSample {
  std::vector<TableColumn> columns;
  std::vector<std::string> comments{};  // lines above the header, which may contain the sample rate
  bool named = true;

  // units: empty without a row of units. cells: by column.
  void set(const std::vector<std::string>& names, const std::vector<std::string>& units,
           const std::vector<std::vector<std::string>>& cells);
  // Keeps the rows with this cell.
  void keep_rows(std::size_t place, const std::string& cell);
  [[nodiscard]] std::vector<std::string> names() const;
  // A column that counts rows ("Sample No.") and is no time, or "".
  [[nodiscard]] std::string counting() const;
};

}  // namespace ifog
