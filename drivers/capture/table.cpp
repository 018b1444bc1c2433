// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/capture.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "drivers/capture/chosen_columns.h"
#include "drivers/capture/column_names.h"
#include "drivers/capture/measurable.h"
#include "drivers/capture/text_file.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr double kMostAngle_rad = 1e9;    // beyond, a float32 resolves 64 rad
constexpr double kMostImpossible = 0.01;  // of a column's cells; more are no single fault of a logger

std::string_view trimmed(std::string_view cell) {
  while (!cell.empty() && (cell.front() == ' ' || cell.front() == '\t')) cell.remove_prefix(1);
  while (!cell.empty() && (cell.back() == ' ' || cell.back() == '\t' || cell.back() == '\r'))
    cell.remove_suffix(1);
  return cell;
}

// Hands out one line at a time, without its end.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    ++number_;
    return true;
  }
  [[nodiscard]] std::size_t number() const { return number_; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

std::string_view unquoted(std::string_view cell) {
  cell = trimmed(cell);
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') cell = cell.substr(1, cell.size() - 2);
  return cell;
}

std::vector<std::string> split_header(std::string_view line, char separator) {
  std::vector<std::string> names;
  for (;;) {
    const std::size_t end = line.find(separator);
    names.emplace_back(unquoted(line.substr(0, end)));
    if (end == std::string_view::npos) return names;
    line.remove_prefix(end + 1);
  }
}

double number(const std::string& path, std::size_t line, const std::string& column, std::string_view cell,
              bool decimal_comma) {
  cell = unquoted(cell);
  if (cell.empty()) return kMissing;
  std::array<char, 64> with_point{};
  std::string_view digits = cell;
  if (const std::size_t comma = cell.find(',');
      decimal_comma && comma < cell.size() && cell.size() <= with_point.size()) {
    std::copy(cell.begin(), cell.end(), with_point.begin());
    with_point[comma] = '.';
    digits = {with_point.data(), cell.size()};
  }
  if (digits.front() == '+') digits.remove_prefix(1);  // from_chars takes no plus sign
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range)
    fail_at(path, line, printable(column) + " is " + in_quotes(cell) + ", outside what a double holds");
  if (error != std::errc() || end != digits.data() + digits.size())
    fail_at(path, line,
            printable(column) + " is " + in_quotes(cell) + ", expected a number, 'nan' or nothing");
  if (std::isinf(value))
    fail_at(path, line, printable(column) + " is infinite, expected a finite number, 'nan' or nothing");
  return value;
}

// The names of the columns, from the first line that is neither empty nor a comment; `line` is then that
// line.
std::vector<std::string> header(Lines& lines, std::string_view& line, const std::string& path,
                                const CsvLayout& layout, Table& table) {
  std::vector<std::string> names;
  while (names.empty() && lines.next(line)) {
    if (trimmed(line).empty()) continue;
    if (line.front() == '#')
      table.comments.emplace_back(trimmed(line.substr(1)));
    else
      names = split_header(line, layout.separator);
  }
  if (names.empty()) throw std::runtime_error(path + ": no header line, expected 'time_s,rate_radps,…'");
  table.header_line = lines.number();
  if (const std::string separator = suggested_separator(std::string(line));
      layout.separator == ',' && !separator.empty())
    fail_at(path, lines.number(),
            "no comma in the header " + in_quotes(line) + "; expected commas, or " + separator);
  if (layout.chooses()) return names;
  if (names.front() != "time_s")
    refuse_header(path, lines.number(), "first column is " + in_quotes(names.front()) + ", expected 'time_s'",
                  names);
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (name.empty()) fail_at(path, lines.number(), "a column has no name");
    if (!seen.insert(name).second)
      fail_at(path, lines.number(), "column " + in_quotes(name) + " stands twice");
  }
  return names;
}

// A column while it is read: what a cell of it can mean, in the file's unit, and where the cells go; nowhere
// for one that nobody chose.
struct Cells {
  std::string name;
  Measurable range;
  std::vector<double>* values = nullptr;
  bool rate = false;           // of the capture: a rate or its reference
  std::size_t impossible = 0;  // cells that said more, and are taken for missing
  std::size_t first_line = 0;  // of those
  std::string first;           // as it stands there
};

bool is_rate(const std::string& column) {
  std::string axis;
  return axis_of(column, "rate", axis) || axis_of(column, "reference_rate", axis);
}

// Of the capture's column, before its conversion.
Measurable in_file_unit(const Measurable& range, const UnitConversion& conversion) {
  const double a = (range.least - conversion.offset) / conversion.scale;
  const double b = (range.most - conversion.offset) / conversion.scale;
  return {std::min(a, b), std::max(a, b)};
}

std::string_view cell_at(std::string_view line, std::size_t place, char separator) {
  for (; place > 0; --place) line.remove_prefix(line.find(separator) + 1);
  return trimmed(line.substr(0, line.find(separator)));
}

// The place of a column that was asked for by its header.
std::size_t place_of(const std::string& wanted, const std::vector<std::string>& names,
                     const std::string& path, std::size_t line) {
  const auto count = std::count(names.begin(), names.end(), wanted);
  if (count == 1)
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), wanted) - names.begin());
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + in_quotes(name);
  fail_at(path, line,
          (count == 0 ? "no column " : "more than one column ") + in_quotes(wanted) + ", the header has " +
              printable(list, kLongestMessage));
}

// What of each column of the file is to be kept, in the file's order.
std::vector<Cells> cells_of(const std::vector<std::string>& names, const CsvLayout& layout,
                            const std::string& path, Table& table) {
  std::vector<Cells> cells(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) cells[i].name = names[i];
  const CsvTime time = layout.time.value_or(CsvTime{});
  Cells& time_cells = cells[place_of(time.header, names, path, table.header_line)];
  time_cells.range = in_file_unit(measurable("time_s"), {time.unit_s, 0.0});
  time_cells.values = &table.time_s;
  // Nothing is added to table.columns once the addresses are taken.
  if (!layout.chooses()) {
    for (std::size_t i = 1; i < names.size(); ++i) table.columns.push_back({names[i], {}});
    for (std::size_t i = 1; i < names.size(); ++i) {
      cells[i].range = measurable(names[i]);
      cells[i].rate = is_rate(names[i]);
      cells[i].values = &table.columns[i - 1].values;
    }
    return cells;
  }
  for (const CsvColumn& column : layout.columns) table.columns.push_back({column.name, {}});
  if (layout.columns.empty())  // --time alone: the others stand under their own names
    for (const std::string& name : names)
      if (name != time.header) table.columns.push_back({name, {}});
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const CsvColumn own{table.columns[i].name, table.columns[i].name, ""};
    const CsvColumn& column = layout.columns.empty() ? own : layout.columns[i];
    Cells& chosen = cells[place_of(column.header, names, path, table.header_line)];
    if (chosen.values != nullptr)
      fail_at(path, table.header_line, "column " + in_quotes(column.header) + " is chosen twice");
    const Measurable range =
        column.is_angle() ? Measurable{-kMostAngle_rad, kMostAngle_rad} : measurable(column.name);
    chosen.range = in_file_unit(range, conversion_of(column));
    chosen.rate = is_rate(column.name);
    chosen.values = &table.columns[i].values;
  }
  return cells;
}

// `text` from the header on. Rows are about as long as the first; one allocation that is large enough beats
// doubling through a long record.
void reserve_rows(std::vector<Cells>& columns, std::string_view text) {
  const std::size_t first_row = text.find('\n');
  if (first_row == std::string_view::npos) return;
  // A row has at least a separator a column: a short second line of a wide file must not ask for all memory.
  const std::size_t length = std::max(text.find('\n', first_row + 1) - first_row, columns.size());
  const std::size_t rows = length > 1 && length < text.size() ? (text.size() - first_row) / length + 1 : 1;
  for (Cells& column : columns)
    if (column.values != nullptr) column.values->reserve(rows + rows / 16);
}

std::string what_no_sensor_measures(const Cells& column) {
  return printable(column.name) + " is " + in_quotes(column.first) + ", which no sensor measures, expected " +
         shortest(column.range.least) + " to " + shortest(column.range.most);
}

void take(Cells& column, std::string_view cell, bool decimal_comma, const std::string& path,
          std::size_t line) {
  const double value = number(path, line, column.name, cell, decimal_comma);
  const bool possible = std::isnan(value) || column.range.holds(value);
  column.values->push_back(possible ? value : kMissing);
  if (possible) return;
  if (column.impossible++ > 0) return;
  column.first_line = line;
  column.first = unquoted(cell);
}

// A cell here and there is a fault of the logger, and is missing; where many are, a rate is not what its name
// says. A channel is only missing then: a broken thermometer is no reason to know nothing of the rate.
void tell_impossible(const std::vector<Cells>& columns, const std::string& path, Table& table) {
  for (const Cells& column : columns) {
    if (column.impossible == 0) continue;
    const auto rows = static_cast<double>(table.time_s.size());
    std::string axis;
    const bool rate = axis_of(column.name, "rate", axis) || axis_of(column.name, "reference_rate", axis);
    const bool few =
        !rate || column.impossible == 1 || static_cast<double>(column.impossible) <= kMostImpossible * rows;
    if (column.values == &table.time_s || (column.rate && rows == 1.0) || !few)
      fail_at(
          path, column.first_line,
          what_no_sensor_measures(column) +
              (column.impossible > 1 ? "; nor " + std::to_string(column.impossible - 1) + " more of its cells"
                                     : ""));
    table.faults.push_back(path + ":" + std::to_string(column.first_line) + ": " +
                           what_no_sensor_measures(column) + "; " + std::to_string(column.impossible) +
                           (column.impossible == 1 ? " such cell" : " such cells") + " taken for missing");
  }
}

void tell_leaps(const std::string& path, Table& table) {
  std::string axis;
  for (CaptureColumn& column : table.columns) {
    if (!axis_of(column.name, "rate", axis) && !axis_of(column.name, "reference_rate", axis)) continue;
    const std::vector<std::size_t> rows = take_out_leaps(table.time_s, column.values);
    if (rows.empty()) continue;
    table.faults.push_back(path + ":" + std::to_string(line_of_row(table, rows.front())) + ": " +
                           printable(column.name) +
                           " says more than half a turn within one sample, from standstill to standstill; " +
                           std::to_string(rows.size()) + (rows.size() == 1 ? " such cell" : " such cells") +
                           " taken for missing");
  }
}

void add_row(std::vector<Cells>& columns, std::string_view line, char separator, const std::string& path,
             std::size_t line_number) {
  std::size_t place = 0;
  for (std::string_view rest = line;;) {
    const std::size_t end = rest.find(separator);
    if (place == columns.size())
      fail_at(path, line_number,
              "more cells than the " + std::to_string(columns.size()) + " columns of the header");
    Cells& column = columns[place];
    if (column.values != nullptr) take(column, rest.substr(0, end), separator != ',', path, line_number);
    ++place;
    if (end == std::string_view::npos) break;
    rest.remove_prefix(end + 1);
  }
  if (place != columns.size())
    fail_at(path, line_number,
            std::to_string(place) + " cells, expected " + std::to_string(columns.size()) +
                " (a truncated line?)");
}

}  // namespace

Table parse_table(std::string_view text, const std::string& path, const CsvLayout& layout) {
  Table table;
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    throw std::runtime_error(path + ": begins as UTF-16 does, expected UTF-8 or ASCII");
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // the byte-order mark
  Lines lines(text);
  std::string_view line;
  const std::vector<std::string> names = header(lines, line, path, layout, table);
  std::vector<Cells> columns = cells_of(names, layout, path, table);
  const std::size_t time = place_of(layout.time.value_or(CsvTime{}).header, names, path, table.header_line);
  reserve_rows(columns, text.substr(static_cast<std::size_t>(line.data() - text.data())));

  bool decimals = false;  // in the first time
  while (lines.next(line)) {
    if (trimmed(line).empty() || line.front() == '#') {
      if (line.starts_with('#')) table.comments.emplace_back(trimmed(line.substr(1)));
      table.skipped.push_back(table.time_s.size());
      continue;
    }
    add_row(columns, line, layout.separator, path, lines.number());
    const double now = table.time_s.back();
    if (columns[time].impossible > 0) tell_impossible(columns, path, table);
    if (table.time_s.size() == 1)
      decimals = cell_at(line, time, layout.separator).find('.') != std::string_view::npos;
    if (std::isnan(now))
      fail_at(path, lines.number(), printable(names[time]) + " is missing, expected a time");
    if (table.time_s.size() > 1 && now <= table.time_s[table.time_s.size() - 2])
      fail_at(path, lines.number(),
              printable(names[time]) + " is " + printable(cell_at(line, time, layout.separator)) +
                  ", expected more than in the row before");
  }
  if (table.time_s.empty()) throw std::runtime_error(path + ": no rows after the header");
  tell_impossible(columns, path, table);
  as_chosen(table, layout, path);
  tell_leaps(path, table);
  if (!layout.time && !decimals) notice_milliseconds(table, path);
  return table;
}

std::size_t line_of_row(const Table& table, std::size_t row) {
  if (table.header_line == 0) return 0;
  const auto before =
      std::upper_bound(table.skipped.begin(), table.skipped.end(), row) - table.skipped.begin();
  return table.header_line + 1 + row + static_cast<std::size_t>(before);
}

Table read_table(const std::string& path) { return parse_table(read_text_file(path), path); }

}  // namespace ifog
