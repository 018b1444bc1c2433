// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/csv/table_form.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/files/input_file.h"
#include "drivers/capture/times/date_time.h"
#include "drivers/ifog/decimal.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/input_limits.h"

namespace ifog {
namespace {

constexpr std::size_t kMostAbove = 1000;  // lines before the first row
constexpr std::size_t kSampleRows = 64;
constexpr std::size_t kRunOfRows = 3;  // that make a table, where the text has as many lines

struct Line {
  std::string_view text;
  std::size_t number = 0;
};

bool is_value(std::string_view cell, bool decimal_comma) {
  if (is_date(cell)) return true;
  const TimeDigits digits(cell, decimal_comma);
  const std::string_view text = digits;
  double value = 0.0;
  const auto [end, error] = read_decimal(text.data(), text.data() + text.size(), value);
  return error != std::errc::invalid_argument && end == text.data() + text.size();
}

// A comment's mark, as loggers write it: "#", "%", "//".
std::string_view without_mark(std::string_view line) {
  line = trimmed(line);
  line.remove_prefix(line.starts_with("//") ? 2 : line.starts_with('#') || line.starts_with('%') ? 1 : 0);
  return trimmed(line);
}
bool is_comment(std::string_view line) { return trimmed(line).starts_with('#'); }

// How many of a line's cells are values, and of how many.
struct Row {
  std::size_t cells = 0, values = 0, empty = 0;
  bool open = false;  // ends with a separator: of one cell more, which is empty, or as some writers end rows
  [[nodiscard]] bool is_as_wide(std::size_t other) const {
    return other == cells || (open && other == cells + 1);
  }
  // Half of what is not empty at least: a name of a frame or a mode may stand among numbers.
  [[nodiscard]] bool is_row() const { return values > 0 && 2 * values >= cells - empty; }
};
Row row_of(std::string_view line, char separator) {
  Row row;
  row.open = separator != ' ' && trimmed(line).ends_with(separator);
  for (const std::string& cell : cells_of(line, separator)) {
    ++row.cells;
    row.values += is_value(cell, separator != ',') ? 1 : 0;
    row.empty += cell.empty() ? 1 : 0;
  }
  return row;
}

// The first line of the table: of rows of as many cells, of which some follow one another where there are as many;
// of several such the one with most values, as a head of names and values may look like a table, too. Nothing where
// there are no rows.
std::optional<std::size_t> first_row(const std::vector<Line>& lines, char separator) {
  struct Table {
    Row first;
    std::size_t begin = 0, run = 0, values = 0,
                last = 0;  // last: its row before, of the lines that are no comments
  };
  std::vector<Table> tables;
  std::size_t plain = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (is_comment(lines[i].text)) continue;
    ++plain;
    const Row row = row_of(lines[i].text, separator);
    if (!row.is_row()) continue;
    auto of = std::find_if(tables.begin(), tables.end(), [&](const Table& table) {
      return table.first.is_as_wide(row.cells) || row.is_as_wide(table.first.cells);
    });
    if (of == tables.end()) of = tables.insert(of, Table{row, i});
    if (of->run < kRunOfRows && of->last + 1 != plain) *of = {row, i};
    of->values += row.values, of->last = plain;
    if (++of->run == kSampleRows) break;
  }
  const auto best = std::max_element(tables.begin(), tables.end(), [](const Table& a, const Table& b) {
    return std::pair(std::min(a.run, kRunOfRows), a.values) <
           std::pair(std::min(b.run, kRunOfRows), b.values);
  });
  return best == tables.end() ? std::nullopt : std::optional(best->begin);
}

// By which most of what stands in the rows is values; of several by which there are most cells.
std::optional<char> separator_of(const std::vector<Line>& lines) {
  std::optional<char> best;
  double best_share = 0.0;
  std::size_t best_cells = 1;
  for (const char separator : {',', ';', '\t', '|', ' '}) {
    const auto begin = first_row(lines, separator);
    if (!begin) continue;
    Row all;
    for (std::size_t i = *begin; i < lines.size() && i < *begin + kSampleRows; ++i) {
      const Row row = row_of(lines[i].text, separator);
      all.cells += row.cells, all.values += row.values, all.empty += row.empty;
    }
    const std::size_t cells = row_of(lines[*begin].text, separator).cells;
    const double share = static_cast<double>(all.values + all.empty) / static_cast<double>(all.cells);
    if (cells < 2 || share < best_share || (share == best_share && cells <= best_cells)) continue;
    best = separator, best_share = share, best_cells = cells;
  }
  return best;
}

// Column names that begin with a capture's time, whatever their separator.
bool is_capture_header(std::string_view line) {
  constexpr std::string_view kTime = "time_s";
  line = unquoted(line);
  if (line.starts_with('"')) line.remove_prefix(1);
  return line.starts_with(kTime) &&
         (line.size() == kTime.size() ||
          std::string_view(",;\t|\" ").find(line[kTime.size()]) != std::string_view::npos);
}

// The names that the layout asks for; of "sec+nsec" both parts.
std::vector<std::string> wanted_names(const CsvLayout& layout) {
  std::vector<std::string> wanted;
  for (const CsvColumn& column : layout.columns) wanted.push_back(column.header);
  if (layout.time) wanted.push_back(layout.time->header);
  if (!layout.only_header.empty()) wanted.push_back(layout.only_header);
  std::erase_if(wanted, [](const std::string& name) { return is_number_of_column(name); });
  return wanted;
}

bool has_names(const std::vector<std::string>& cells, const std::vector<std::string>& wanted) {
  const auto has = [&](const std::string& name) {
    return std::find(cells.begin(), cells.end(), name) != cells.end();
  };
  return std::all_of(wanted.begin(), wanted.end(), [&](const std::string& name) {
    const std::vector<std::string> parts = parts_of_time(name, has);
    return std::all_of(parts.begin(), parts.end(), has);
  });
}

// Which of the lines is the header; nothing where there is none.
struct Header {
  std::optional<std::size_t> at;
  std::vector<std::string> names;
};

// The cells of a line above rows that are so wide. Some programs separate the names otherwise than the values:
// "A_X [mg] A_Y [mg]" above tabs, where a unit belongs to the name before it.
std::vector<std::string> names_in(std::string_view line, char separator, const Row& rows) {
  const std::vector<std::string> names = cells_of(without_mark(line), separator);
  if (rows.is_as_wide(names.size())) return names;
  for (const char other : {',', ';', '\t', ' '}) {
    std::vector<std::string> cells;
    for (std::string& cell : cells_of(without_mark(line), other))
      if (other == ' ' && !cells.empty() && (cell.starts_with('[') || cell.starts_with('(')))
        cells.back() += ' ' + cell;
      else
        cells.push_back(std::move(cell));
    if (cells.size() > 1 && rows.is_as_wide(cells.size())) return cells;
  }
  return names;
}

Header header_of(const std::vector<Line>& lines, char separator, const CsvLayout& layout) {
  const std::vector<std::string> wanted = wanted_names(layout);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (is_comment(lines[i].text)) continue;
    std::vector<std::string> cells = cells_of(without_mark(lines[i].text), separator);
    if (is_capture_header(lines[i].text) || (!wanted.empty() && has_names(cells, wanted)))
      return {i, std::move(cells)};
  }
  const auto row = first_row(lines, separator);
  if (!row) return {};
  const Row first = row_of(lines[*row].text, separator);
  // A row of units may stand between.
  for (std::size_t back = 1; back <= 2 && back <= *row; ++back) {
    std::vector<std::string> cells = names_in(lines[*row - back].text, separator, first);
    const bool units = back == 1 && std::any_of(cells.begin(), cells.end(), is_unit) && *row >= 2 &&
                       first.is_as_wide(cells_of(without_mark(lines[*row - 2].text), separator).size());
    if (first.is_as_wide(cells.size()) && !units && !row_of(lines[*row - back].text, separator).is_row())
      return {*row - back, std::move(cells)};
    if (!units) break;
  }
  return {};
}

// The units that a row below the names says, where it is one: each cell a text, at least one of them a unit.
std::vector<std::string> units_in(const Line& line, char separator, std::size_t names) {
  std::vector<std::string> units = cells_of(without_mark(line.text), separator);
  if (units.size() != names) return {};
  const auto value = [&](const std::string& cell) { return cell != "1" && is_value(cell, separator != ','); };
  for (std::string& unit : units) unit = without_brackets(unit);
  if (std::any_of(units.begin(), units.end(), value) || std::none_of(units.begin(), units.end(), is_unit))
    return {};
  for (std::string& unit : units)
    if (unit == "-" || unit == "1") unit.clear();
  return units;
}

std::vector<Line> first_lines(std::string_view text, const std::string& path) {
  Lines lines(text);
  std::vector<Line> out;
  std::string_view line;
  std::size_t plain = 0;
  while (plain < kMostAbove + kSampleRows && lines.next(line)) {
    if (line.size() > kLongestLine) refuse_long_line(path, lines.number(), line);
    if (trimmed(line).empty()) continue;
    out.push_back({line, lines.number()});
    plain += is_comment(line) ? 0 : 1;
  }
  return out;
}

// Text of other programs that looks like rows here and there, with the program that makes a table of it.
void refuse_what_is_no_table(const std::vector<Line>& lines, const std::vector<std::string>& given,
                             const std::string& path) {
  const auto separates = [](const Line& line) { return line.text == "---"; };
  if (!lines.empty() && trimmed(lines[0].text).ends_with(':') &&
      std::count_if(lines.begin(), lines.end(), separates) > 1)
    fail_at(
        path, 0,
        "is YAML as rostopic echo prints it, expected a table; rostopic echo -p, or ros2 topic echo --csv, "
        "writes one");
  if (std::any_of(given.begin(), given.end(),
                  [](const std::string& name) { return name.find('{') != std::string::npos; }))
    fail_at(
        path, 0,
        "is JSON with objects inside of objects, expected a table; jq -r '[.t, .gyro.x, .gyro.y, .gyro.z] | "
        "@csv', with the names of this file, makes one");
}

// A LabVIEW measurement file has two heads, and a last name, Comment, that most rows have no cell for.
// Returns the cells of its row of units. Source: NI, "Specification for the LabVIEW Measurement File (.lvm)".
std::vector<std::string> without_heads(std::vector<Line>& lines, std::vector<std::string>& comments) {
  const auto last = std::find_if(lines.rbegin(), lines.rend(), [&](const Line& line) {
    return line.text.starts_with("***End_of_Header***");
  });
  std::vector<std::string> units;
  if (lines.empty() || !lines[0].text.starts_with("LabVIEW Measurement") || last == lines.rend())
    return units;
  for (auto line = lines.begin(); line != last.base(); ++line) {
    std::vector<std::string> cells = cells_of(line->text, '\t');
    if (cells.size() < 2) continue;
    const auto step_s = finite_number(PointDigits(cells[1], true));
    if (cells[0] == "Delta_X" && step_s && *step_s > 0.0)
      comments.push_back("sample rate " + shortest(1.0 / *step_s));
    if (cells[0] == "Y_Unit_Label") {
      units = std::move(cells);
      units[0].clear();
    }
  }
  lines.erase(lines.begin(), last.base());
  if (!lines.empty() && lines[0].text.ends_with("\tComment"))
    lines[0].text.remove_suffix(std::string_view("\tComment").size());
  return units;
}

void sample_rows(const std::vector<Line>& lines, std::size_t from, TableForm& form) {
  TableSample& sample = form.sample;
  sample.cells.resize(sample.names.size());
  for (std::size_t i = from; i < lines.size() && sample.cells[0].size() < kSampleRows; ++i) {
    if (is_comment(lines[i].text)) continue;
    std::vector<std::string> cells = cells_of(lines[i].text, form.separator);
    if (cells.size() + 1 == sample.names.size() && row_of(lines[i].text, form.separator).open)
      cells.emplace_back();
    if (cells.size() != sample.names.size()) continue;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const TimeDigits digits(cells[c], form.separator != ',');
      sample.cells[c].emplace_back(digits.is_date() ? std::string_view(cells[c]) : std::string_view(digits));
    }
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

// "He said ""no"", and left": a quote inside is doubled.
std::size_t cell_end(std::string_view row, char separator) {
  std::size_t at = 0;
  while (row.substr(at).starts_with('"')) {
    const std::size_t closing = row.find('"', at + 1);
    if (closing == std::string_view::npos) break;
    at = closing + 1;
  }
  return std::min(row.find(separator, at), row.size());
}

std::vector<std::string> cells_of(std::string_view line, char separator) {
  std::vector<std::string> cells;
  if (separator == ' ') line = trimmed(line);
  for (;;) {
    const std::size_t end = cell_end(line, separator);
    cells.emplace_back(unquoted(line.substr(0, end)));
    if (end == line.size()) break;
    line.remove_prefix(end + 1);
    while (separator == ' ' && !line.empty() && line.front() == ' ') line.remove_prefix(1);
  }
  // As rows are that end with a separator.
  if (cells.size() > 1 && cells.back().empty()) cells.pop_back();
  return cells;
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

TableForm table_form(std::string_view text, const std::vector<std::string>& given, const std::string& path,
                     const CsvLayout& layout) {
  std::vector<Line> lines = first_lines(text, path);
  TableForm form;
  TableSample& sample = form.sample;
  refuse_what_is_no_table(lines, given, path);
  const std::vector<std::string> units = without_heads(lines, sample.comments);
  std::optional<char> separator;
  if (layout.separator != '\0') separator = layout.separator;
  if (!given.empty()) separator = ',';
  // What spreadsheets write above the header.
  if (!lines.empty() && lines[0].text.size() == 5 &&
      (lines[0].text.starts_with("sep=") || lines[0].text.starts_with("SEP="))) {
    if (!separator) separator = lines[0].text[4];
    lines.erase(lines.begin());
  }
  const auto plain =
      std::find_if(lines.begin(), lines.end(), [](const Line& line) { return !is_comment(line.text); });
  if (plain == lines.end()) fail_at(path, 0, "no header line, expected 'time_s,rate_radps,…'");
  if (!separator && is_capture_header(plain->text) && plain->text.find(',') != std::string_view::npos)
    separator = ',';
  if (!separator) separator = separator_of(lines);
  form.separator = separator.value_or(',');
  for (const Line& line : lines)
    if (!is_comment(line.text) && row_of(line.text, form.separator).cells > kInputLimits.csv_columns)
      fail_at(path, line.number,
              "more than " + std::to_string(kInputLimits.csv_columns) +
                  " columns, expected at most that (cut -d, -f1-9 takes some)");
  const Header header = given.empty() ? header_of(lines, form.separator, layout) : Header();
  std::size_t first = 0;  // row
  if (header.at) {
    sample.names = header.names;
    form.header_line = form.last_line = lines[*header.at].number;
    first = *header.at + 1;
    if (first < lines.size()) sample.units = units_in(lines[first], form.separator, sample.names.size());
    if (!sample.units.empty()) form.last_line = lines[first++].number;
    if (units.size() == sample.names.size()) sample.units = units;
  } else if (const auto row = first_row(lines, form.separator)) {
    sample.named = !given.empty();
    sample.names = given;
    for (std::size_t i = 0; given.empty() && i < row_of(lines[*row].text, form.separator).cells; ++i)
      sample.names.push_back("#" + std::to_string(i + 1));
    first = *row;
    form.last_line = lines[*row].number - 1;
  } else {
    fail_at(path, plain->number,
            "no table found, expected a header 'time_s,rate_radps,…' and rows of numbers below; the first "
            "line is " +
                in_quotes(plain->text));
  }
  for (std::size_t i = 0;
       i < lines.size() && lines[i].number < (header.at ? form.header_line : form.last_line + 1); ++i)
    sample.comments.emplace_back(is_comment(lines[i].text) ? trimmed(trimmed(lines[i].text).substr(1))
                                                           : trimmed(lines[i].text));
  sample_rows(lines, first, form);
  return form;
}

}  // namespace ifog
