// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/times/row_sink.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <stdexcept>

namespace ifog {

double median_step_s(const std::vector<double>& time_s) {
  if (time_s.size() < 2) return kMissing;
  std::vector<double> steps(time_s.size());
  std::adjacent_difference(time_s.begin(), time_s.end(), steps.begin());
  steps.erase(steps.begin());
  return median(std::move(steps));
}

void RowBlock::append(RowBlock& rows) {
  if (size() == 0) return std::swap(*this, rows);
  if (rows.size() == 0) return;
  time_s.insert(time_s.end(), rows.time_s.begin(), rows.time_s.end());
  lines.insert(lines.end(), rows.lines.begin(), rows.lines.end());
  cells.insert(cells.end(), rows.cells.begin(), rows.cells.end());
  for (std::size_t c = 0; c < columns.size(); ++c)
    columns[c].insert(columns[c].end(), rows.columns[c].begin(), rows.columns[c].end());
}

void RowBlock::move_row(std::size_t from, std::size_t to) {
  if (from == to) return;
  time_s[to] = time_s[from];
  if (!lines.empty()) lines[to] = lines[from];
  if (!cells.empty()) cells[to] = cells[from];
  for (std::vector<double>& column : columns) column[to] = column[from];
}

void RowBlock::keep_first(std::size_t rows) {
  time_s.resize(rows);
  lines.resize(std::min(rows, lines.size()));
  cells.resize(std::min(rows, cells.size()));
  for (std::vector<double>& column : columns) column.resize(rows);
}

void RowBatch::begin(const std::vector<std::string>& names) {
  rows_.columns.resize(names.size());
  sink_.begin(names);
}

void RowBatch::add(double time_s, std::span<const double> values, const TimeOrigin& origin) {
  rows_.origin = origin;
  rows_.time_s.push_back(time_s);
  for (std::size_t c = 0; c < values.size(); ++c) rows_.columns[c].push_back(values[c]);
  if (rows_.size() == kRows) hand_on();
}

void RowBatch::hand_on() {
  const std::size_t columns = rows_.columns.size();
  if (rows_.size() > 0) sink_.take(rows_);
  rows_.time_s.clear();
  rows_.columns.assign(columns, {});
}

void RowBlock::split_off(std::size_t from, RowBlock& to) {
  const auto behind = [from](auto& values, auto& kept) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(std::min(from, values.size()));
    kept.assign(begin, values.end());
    values.erase(begin, values.end());
  };
  to.origin = origin;
  to.columns.resize(columns.size());
  behind(time_s, to.time_s);
  behind(lines, to.lines);
  behind(cells, to.cells);
  for (std::size_t c = 0; c < columns.size(); ++c) behind(columns[c], to.columns[c]);
}

std::string at_line(const std::string& path, std::size_t line, const std::string& what) {
  return path + (line == 0 ? "" : ":" + std::to_string(line)) + ": " + what;
}

void fail_at(const std::string& path, std::size_t line, const std::string& what) {
  throw std::runtime_error(at_line(path, line, what));
}

void RowNotes::dropped(const Fault& found, const std::string& kind) {
  const std::size_t count = found.count;
  fault(found.line,
        found.first + "; " +
            (count == 1 ? "this " + kind + " is" : std::to_string(count) + " such " + kind + "s are") +
            " dropped");
}

void RowNotes::add_lines(std::size_t rows, const RowBlock& block) {
  for (std::size_t i = 0; i < block.lines.size(); ++i)
    if (lines.empty() || block.lines[i] - lines.back().line != rows + i - lines.back().row)
      lines.push_back({rows + i, block.lines[i]});
}

std::size_t RowNotes::line_of_row(std::size_t row) const {
  const auto behind = std::ranges::upper_bound(lines, row, {}, &Lines::row);
  return behind == lines.begin() ? 0 : std::prev(behind)->line + (row - std::prev(behind)->row);
}

}  // namespace ifog
