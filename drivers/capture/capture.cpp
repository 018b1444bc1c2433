// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/capture.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/csv/csv_rows.h"
#include "drivers/capture/csv/text_cells.h"
#include "drivers/ifog/quoted.h"

namespace ifog {

void TableSink::begin(const std::vector<std::string>& names) {
  for (const std::string& name : names) table_.columns.push_back({name, {}});
}

void TableSink::take(RowBlock& rows) {
  table_.origin = rows.origin;
  table_.time_s.insert(table_.time_s.end(), rows.time_s.begin(), rows.time_s.end());
  for (std::size_t c = 0; c < rows.columns.size(); ++c)
    table_.columns[c].values.insert(table_.columns[c].values.end(), rows.columns[c].begin(),
                                    rows.columns[c].end());
}

Table table_of(const std::function<RowNotes(RowSink&)>& read) {
  Table table;
  TableSink sink(table);
  static_cast<RowNotes&>(table) = read(sink);
  return table;
}

Table read_table(InputFile& file, const CsvLayout& layout) {
  return table_of([&](RowSink& sink) { return read_csv_rows(file, layout, sink); });
}

Capture known_part_of(Table table, const std::string& path) {
  std::string axis;
  std::vector<std::string> dead;
  std::erase_if(table.columns, [&](const CaptureColumn& column) {
    const bool known = std::ranges::any_of(column.values, [](double v) { return !std::isnan(v); });
    if (!known && axis_of(column.name, "rate", axis)) dead.push_back(axis);
    return !known;
  });
  if (std::ranges::none_of(table.columns,
                           [&](const CaptureColumn& column) { return axis_of(column.name, "rate", axis); }))
    throw std::runtime_error("the device marks every value of every axis invalid");
  Capture capture = capture_of(std::move(table), path);
  capture.dead_axes = std::move(dead);
  return capture;
}

Capture capture_of(Table table, const std::string& path) {
  std::vector<std::string> names;
  for (const CaptureColumn& column : table.columns) names.push_back(column.name);
  const CaptureShape shape = capture_shape(names, path, table);
  Capture capture;
  capture.notices = std::move(table.notices);
  capture.faults = std::move(table.faults);
  capture.comments = lines_of(table.comments);
  capture.since_power_up_s = table.since_power_up_s;
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
  if (shape.axes.empty()) fail_at(path, notes.header_line, no_rate_among(names));
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

}  // namespace ifog
