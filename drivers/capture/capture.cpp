// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/capture.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <string_view>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/csv/csv_rows.h"
#include "drivers/capture/csv/text_cells.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

// Blocks become whole columns.
class TableSink final : public RowSink {
 public:
  explicit TableSink(Table& table) : table_(table) {}

  void begin(const std::vector<std::string>& names) override {
    for (const std::string& name : names) table_.columns.push_back({name, {}});
  }
  void take(RowBlock& rows) override {
    table_.origin = rows.origin;
    table_.time_s.insert(table_.time_s.end(), rows.time_s.begin(), rows.time_s.end());
    for (std::size_t c = 0; c < rows.columns.size(); ++c)
      table_.columns[c].values.insert(table_.columns[c].values.end(), rows.columns[c].begin(),
                                      rows.columns[c].end());
  }

 private:
  Table& table_;
};

}  // namespace

Table table_of(const std::function<RowNotes(RowSink&)>& read) {
  Table table;
  TableSink sink(table);
  static_cast<RowNotes&>(table) = read(sink);
  return table;
}

Table read_table(InputFile& file, const CsvLayout& layout) {
  return table_of([&](RowSink& sink) { return read_csv_rows(file, layout, sink); });
}

double median_value(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double median_step_s(const std::vector<double>& time_s) {
  if (time_s.size() < 2) return kMissing;
  std::vector<double> steps(time_s.size());
  std::adjacent_difference(time_s.begin(), time_s.end(), steps.begin());
  steps.erase(steps.begin());
  return median_value(std::move(steps));
}

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> out;
  Lines lines(text);
  for (std::string_view line; lines.next(line);) out.emplace_back(line);
  return out;
}

void RowBlock::append(RowBlock& rows) {
  if (size() == 0) return std::swap(*this, rows);
  time_s.insert(time_s.end(), rows.time_s.begin(), rows.time_s.end());
  lines.insert(lines.end(), rows.lines.begin(), rows.lines.end());
  for (std::size_t c = 0; c < columns.size(); ++c)
    columns[c].insert(columns[c].end(), rows.columns[c].begin(), rows.columns[c].end());
}

void RowBlock::move_row(std::size_t from, std::size_t to) {
  if (from == to) return;
  time_s[to] = time_s[from];
  if (!lines.empty()) lines[to] = lines[from];
  for (std::vector<double>& column : columns)
    if (!column.empty()) column[to] = column[from];
}

void RowBlock::keep_first(std::size_t rows) {
  time_s.resize(rows);
  if (!lines.empty()) lines.resize(rows);
  for (std::vector<double>& column : columns)
    if (!column.empty()) column.resize(rows);
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
  for (std::size_t c = 0; c < columns.size(); ++c) behind(columns[c], to.columns[c]);
}

void RowNotes::add_lines(std::size_t rows, const RowBlock& block) {
  for (std::size_t i = 0; i < block.lines.size(); ++i)
    if (lines.empty() || block.lines[i] - lines.back().line != rows + i - lines.back().row)
      lines.push_back({rows + i, block.lines[i]});
}

std::size_t RowNotes::line_of_row(std::size_t row) const {
  const auto behind =
      std::upper_bound(lines.begin(), lines.end(), row,
                       [](std::size_t wanted, const Lines& each) { return wanted < each.row; });
  return behind == lines.begin() ? 0 : std::prev(behind)->line + (row - std::prev(behind)->row);
}

Capture capture_of(Table table, const std::string& path) {
  std::vector<std::string> names;
  for (const CaptureColumn& column : table.columns) names.push_back(column.name);
  const CaptureShape shape = capture_shape(names, path, table);
  Capture capture;
  capture.notices = std::move(table.notices);
  capture.faults = std::move(table.faults);
  capture.comments = lines_of(table.comments);
  capture.origin = table.origin;
  capture.time_s = std::move(table.time_s);
  capture.axes = shape.axes;
  capture.rate_radps.resize(shape.axes.size());
  capture.reference_rate_radps.resize(shape.axes.size());
  using Kind = CaptureShape::Place::Kind;
  for (std::size_t c = 0; c < names.size(); ++c) {
    const CaptureShape::Place& place = shape.places[c];
    if (place.kind == Kind::rate)
      capture.rate_radps[place.at] = std::move(table.columns[c].values);
    else if (place.kind == Kind::reference)
      capture.reference_rate_radps[place.at] = std::move(table.columns[c].values);
    else
      capture.channels.push_back(std::move(table.columns[c]));
  }
  return capture;
}

CaptureShape capture_shape(const std::vector<std::string>& names, const std::string& path,
                           const RowNotes& notes) {
  CaptureShape shape;
  std::string axis;
  for (const std::string& name : names)
    if (axis_of(name, "rate", axis)) shape.axes.push_back(axis);
  if (shape.axes.empty()) {
    fail_at(
        path, notes.header_line,
        "no rate column among " + listed(names) +
            ", expected 'rate_radps' or 'rate_x_radps', …, or --column rate_x_radps=NAME:UNIT with one of "
            "these names");
  }
  const auto index_of = [&](const std::string& name) {
    for (std::size_t i = 0; i < shape.axes.size(); ++i)
      if (shape.axes[i] == name) return i;
    fail_at(path, notes.header_line, "reference column of axis " + in_quotes(name) + " has no rate column");
  };
  using Kind = CaptureShape::Place::Kind;
  for (const std::string& name : names) {
    if (axis_of(name, "rate", axis))
      shape.places.push_back({Kind::rate, index_of(axis)});
    else if (axis_of(name, "reference_rate", axis))
      shape.places.push_back({Kind::reference, index_of(axis)});
    else
      shape.places.push_back({Kind::channel, shape.channels++});
  }
  return shape;
}

Capture read_capture(const std::string& path) {
  InputFile file(path);
  return capture_of(read_table(file), path);
}

Capture parse_capture(std::string_view text, const std::string& path, const CsvLayout& layout) {
  InputFile file(path, std::string(text));
  return capture_of(read_table(file, layout), path);
}

}  // namespace ifog
