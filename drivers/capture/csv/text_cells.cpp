// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/csv/text_cells.h"

#include <algorithm>
#include <array>
#include <boost/algorithm/string/replace.hpp>
#include <system_error>
#include <utility>

#include "drivers/capture/columns/column.h"
#include "drivers/capture/files/input_file.h"
#include "drivers/capture/times/date_time.h"
#include "drivers/ifog/decimal.h"

namespace ifog {
namespace {

constexpr std::size_t kRunOfRows = 3;  // consecutive rows that make a table, if the text has so many lines

Row row_of(std::string_view line, char separator) {
  Row row;
  row.comment = is_comment(line);
  if (row.comment) return row;
  row.cells = cells_of(line, separator);
  row.open = separator != ' ' && trimmed(line).ends_with(separator);
  for (const std::string& cell : row.cells) {
    row.values += is_value(cell, separator) ? 1 : 0;
    row.empty += cell.empty() ? 1 : 0;
  }
  return row;
}

// A quoted cell of at most kLongestQuoted bytes may hold line ends (RFC 4180). It begins and ends beside a separator.
std::size_t line_end(std::string_view text) {
  const auto is_beside = [&](std::size_t at) {
    return at >= text.size() || std::string_view(",;\t|\r\n").find(text[at]) != std::string_view::npos;
  };
  std::size_t at = 0, end = std::min(text.find('\n'), text.size());
  for (std::size_t open; (open = text.substr(0, end).find('"', at)) != std::string_view::npos;) {
    at = open + 1;
    if (open > 0 && !is_beside(open - 1)) continue;
    const std::string_view near = text.substr(0, open + kLongestQuoted);
    std::size_t close = near.find('"', at);
    while (close < near.size() && near.substr(close).starts_with("\"\"")) close = near.find('"', close + 2);
    if (close > near.size() || !is_beside(close + 1)) continue;
    at = close + 1;
    if (at > end) end = std::min(text.find('\n', at), text.size());
  }
  return end;
}

}  // namespace

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> out;
  Lines lines(text);
  for (std::string_view line; lines.next(line);) out.emplace_back(line);
  return out;
}

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

// "He said ""no""": a quote inside is doubled.
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
    std::string& cell = cells.emplace_back(unquoted(line.substr(0, end)));
    boost::algorithm::replace_all(cell, "\"\"", "\"");
    if (end == line.size()) break;
    line.remove_prefix(end + 1);
    while (separator == ' ' && !line.empty() && line.front() == ' ') line.remove_prefix(1);
  }
  // Rows may end with a separator.
  if (cells.size() > 1 && cells.back().empty()) cells.pop_back();
  return cells;
}

std::string as_cell(const std::string& text) {
  const bool plain = !text.empty() && text.front() != ' ' && text.back() != ' ';
  if (plain && text.find_first_of(",\"") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

bool Lines::next(std::string_view& line) {
  if (rest_.empty()) return false;
  const std::size_t end = line_end(rest_);
  line = rest_.substr(0, end);
  number_ += static_cast<std::size_t>(std::ranges::count(line, '\n'));
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  // The checksum of NMEA 0183 and its relatives: $VNYMR,…*69.
  if (line.size() > 3 && line.front() == '$' && line[line.size() - 3] == '*') line.remove_suffix(3);
  ++number_;
  return true;
}

std::string_view without_mark(std::string_view line) {
  line = trimmed(line);
  line.remove_prefix(line.starts_with("//") ? 2 : line.starts_with('#') || line.starts_with('%') ? 1 : 0);
  return trimmed(line);
}

bool is_no_number(std::string_view cell) {
  constexpr std::array<std::string_view, 6> kWords{"na", "n/a", "#n/a", "null", "none", "-"};
  return cell.substr(cell.starts_with('-') ? 1 : 0).starts_with("1.#") ||
         std::ranges::find(kWords, lower(std::string(cell))) != kWords.end();
}

bool is_value(std::string_view cell, char separator) {
  if (is_date(cell)) return true;
  const PointDigits digits(cell, {separator != ','});
  const std::string_view text = digits;
  double value = 0.0;
  const auto [end, error] = read_decimal(text.data(), text.data() + text.size(), value);
  return error != std::errc::invalid_argument && end == text.data() + text.size();
}

Grid::Grid(const std::vector<Line>& lines, char separator) : separator_(separator) {
  for (const Line& line : lines) rows_.push_back(row_of(line.text, separator));
  find_first();
}

Grid Grid::of(const std::vector<Line>& lines) {
  std::optional<Grid> best;
  for (const char separator : {',', ';', '\t', '|', ' '}) {
    Grid grid(lines, separator);
    if (grid.width() < 2) continue;
    if (!best || std::pair(grid.share(), grid.width()) > std::pair(best->share(), best->width()))
      best = std::move(grid);
  }
  return best ? std::move(*best) : Grid(lines, ',');
}

// The table has consecutive rows of equally many cells. Of several such groups the one with most values is
// used, because a head of names and values may look like a table.
void Grid::find_first() {
  struct Table {
    std::size_t begin = 0, run = 0, values = 0;
    std::size_t last = 0;  // its previous row, counted without comments
  };
  std::vector<Table> tables;
  std::size_t plain = 0;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row& row = rows_[i];
    plain += row.comment ? 0 : 1;
    if (!row.is_row()) continue;
    auto of = std::ranges::find_if(tables, [&](const Table& table) {
      const Row& first = rows_[table.begin];
      return first.is_as_wide(row.cells.size()) || row.is_as_wide(first.cells.size());
    });
    if (of == tables.end()) of = tables.insert(of, Table{i});
    if (of->run < kRunOfRows && of->last + 1 != plain) *of = {i};
    of->values += row.values, of->last = plain;
    if (++of->run == kSampleRows) break;
  }
  const auto best = std::ranges::max_element(tables, {}, [](const Table& table) {
    return std::pair(std::min(table.run, kRunOfRows), table.values);
  });
  if (best != tables.end()) first_ = best->begin;
}

// Share of values among non-empty cells.
double Grid::share() const {
  std::size_t cells = 0, values = 0;
  for (std::size_t i = *first_; i < rows_.size() && i < *first_ + kSampleRows; ++i) {
    cells += rows_[i].cells.size();
    values += rows_[i].values + rows_[i].empty;
  }
  return static_cast<double>(values) / static_cast<double>(cells);
}

}  // namespace ifog
