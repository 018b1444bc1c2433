// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/csv_header.h"

#include <algorithm>
#include <charconv>
#include <set>
#include <stdexcept>

#include "drivers/capture/column_names.h"
#include "drivers/capture/date_time.h"
#include "drivers/capture/input_file.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

std::vector<std::string> split(std::string_view line, char separator) {
  std::vector<std::string> names;
  for (;;) {
    const std::size_t end = line.find(separator);
    names.emplace_back(unquoted(line.substr(0, end)));
    if (end == std::string_view::npos) break;
    line.remove_prefix(end + 1);
  }
  // As rows are that end with a separator.
  if (names.size() > 1 && names.back().empty()) names.pop_back();
  return names;
}

bool is_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  return read.ec == std::errc() && read.ptr == end;
}

// A line of numbers, whatever stands between them, is no header.
void refuse_numbers(std::string_view line, const std::string& path, std::size_t number) {
  constexpr std::string_view kBetween = ",;|\t ";
  std::string first;
  for (std::size_t from = 0; from < line.size();) {
    const std::size_t to = std::min(line.find_first_of(kBetween, from), line.size());
    const std::string cell(unquoted(line.substr(from, to - from)));
    from = to + 1;
    if (cell.empty()) continue;
    if (!is_number(cell)) return;
    if (first.empty()) first = cell;
  }
  if (first.empty()) return;
  fail_at(path, number,
          "begins with numbers, " + in_quotes(first) +
              ", …, expected a header before them: 'time_s,rate_radps,…'");
}

// A row below the names that says their units joins them, where it is one: each cell a text, at least one of
// them a unit.
void join_units(Lines& lines, const std::string& path, char separator, std::vector<std::string>& names) {
  Lines ahead = lines;
  std::string_view line;
  if (!ahead.next(line) || line.size() > kLongestLine || line.starts_with('#')) return;
  std::vector<std::string> units = split(line, separator);
  if (units.size() != names.size()) return;
  const auto value = [](const std::string& cell) {
    return (cell != "1" && is_number(cell)) || is_date(cell);
  };
  if (std::any_of(units.begin(), units.end(), value) || std::none_of(units.begin(), units.end(), is_unit))
    return;
  lines = ahead;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto joined = name_with_unit(names[i], units[i]);
    if (!joined)
      fail_at(path, lines.number(),
              "the row of units says " + in_quotes(units[i]) + " of " + in_quotes(names[i]) +
                  ", expected the unit of its name");
    names[i] = *joined;
  }
}

// Whether a cell of the first row is a date.
bool dated(Lines rows, char separator) {
  std::string_view row;
  while (rows.next(row) && (trimmed(row).empty() || row.front() == '#')) {
  }
  for (std::size_t from = 0; from <= row.size();) {
    const std::size_t to = std::min(row.find(separator, from), row.size());
    if (is_date(unquoted(row.substr(from, to - from)))) return true;
    from = to + 1;
  }
  return false;
}

void check_names(const std::vector<std::string>& names, const std::string& path, std::size_t line,
                 const Lines& rows, char separator) {
  if (names.front() != "time_s")
    refuse_header(path, line, "first column is " + in_quotes(names.front()) + ", expected 'time_s'", names,
                  dated(rows, separator));
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (name.empty()) fail_at(path, line, "a column has no name");
    if (!seen.insert(name).second) fail_at(path, line, "column " + in_quotes(name) + " stands twice");
  }
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

// What of each column of the file is to be kept.
void choose(const std::vector<std::string>& names, const CsvLayout& layout, const std::string& path,
            CsvHeader& header) {
  header.cells.resize(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) header.cells[i].name = names[i];
  const CsvTime time = layout.time.value_or(CsvTime{});
  if (const std::string unit = time.other_unit(); !unit.empty())
    fail_at(path, header.line, unit_by_name(time.header, unit, option_for(time, unit)));
  header.time_place = place_of(time.header, names, path, header.line);
  CsvCell& time_cell = header.cells[header.time_place];
  time_cell.range = measurable_in_file(time);
  time_cell.column = CsvCell::kTime;
  if (!layout.chooses()) {
    for (std::size_t i = 1; i < names.size(); ++i) {
      header.cells[i] = {names[i], measurable(names[i]), is_rate_column(names[i]), i - 1};
      header.names.push_back(names[i]);
    }
    return;
  }
  std::vector<CsvColumn> columns = layout.columns;
  if (columns.empty())  // --time alone: the others stand under their own names
    for (const std::string& name : names)
      if (name != time.header) columns.push_back({name, name, ""});
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const CsvColumn& column = columns[i];
    CsvCell& chosen = header.cells[place_of(column.header, names, path, header.line)];
    if (const std::string unit = column.other_unit(); !unit.empty())
      fail_at(path, header.line, unit_by_name(column.header, unit, option_for(column, unit)));
    if (chosen.column != CsvCell::kPassedOver)
      fail_at(path, header.line, "column " + in_quotes(column.header) + " is chosen twice");
    chosen.range = measurable_in_file(column);
    chosen.rate = is_rate_column(column.name);
    chosen.column = i;
    header.names.push_back(column.name);
  }
}

}  // namespace

std::string_view trimmed(std::string_view cell) {
  while (!cell.empty() && (cell.front() == ' ' || cell.front() == '\t')) cell.remove_prefix(1);
  while (!cell.empty() && (cell.back() == ' ' || cell.back() == '\t' || cell.back() == '\r'))
    cell.remove_suffix(1);
  return cell;
}

std::string_view unquoted(std::string_view cell) {
  cell = trimmed(cell);
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') cell = cell.substr(1, cell.size() - 2);
  return cell;
}

bool Lines::next(std::string_view& line) {
  if (rest_.empty()) return false;
  const std::size_t end = rest_.find('\n');
  line = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  ++number_;
  return true;
}

bool read_csv_header(Lines& lines, const std::string& path, const CsvLayout& layout, CsvHeader& header) {
  std::vector<std::string> names;
  std::string_view line;
  while (names.empty() && lines.next(line)) {
    if (line.size() > kLongestLine) refuse_long_line(path, lines.number(), line);
    if (trimmed(line).empty()) continue;
    if (line.front() == '#')
      header.comments.append(trimmed(line.substr(1))) += '\n';
    else
      names = split(line, layout.separator);
  }
  if (names.empty()) return false;
  header.line = lines.number();
  const std::vector<std::string> as_written = names;
  join_units(lines, path, layout.separator, names);
  header.last_line = lines.number();
  CsvLayout joined = layout;
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (CsvColumn& column : joined.columns)
      if (column.header == as_written[i]) column.header = names[i];
    if (joined.time && joined.time->header == as_written[i]) joined.time->header = names[i];
  }
  // Numbers may be the names of columns that were asked for by them.
  const auto asked_for = [&](const std::string& column) {
    return std::find(names.begin(), names.end(), column) != names.end();
  };
  if (!layout.chooses() || !asked_for(joined.time.value_or(CsvTime{}).header))
    refuse_numbers(line, path, header.line);
  if (const std::string separator = suggested_separator(std::string(line));
      layout.separator == ',' && !separator.empty())
    fail_at(path, header.line,
            "no comma in the header " + in_quotes(line) + "; expected commas, or " + separator);
  if (!layout.chooses()) check_names(names, path, header.line, lines, layout.separator);
  choose(names, joined, path, header);
  return true;
}

}  // namespace ifog
