// SPDX-License-Identifier: Apache-2.0
// Whole captures in memory, as tests read them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/capture/capture.h"
#include "drivers/capture/capture_builder.h"
#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/csv/csv_rows.h"
#include "drivers/capture/csv/text_cells.h"
#include "drivers/capture/files/input_file.h"
#include "tests/unit/refusal.h"

namespace ifog {

// All columns of a file under their own names. A rate is not required.
struct Table : RowNotes {
  TimeOrigin origin;  // of time_s
  std::vector<double> time_s;
  std::vector<CaptureColumn> columns;  // all but time_s, in the file's order
};

// Collects blocks into whole columns.
class TableSink : public RowSink {
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

// Table of the rows that `read` delivers to its sink.
inline Table table_of(const std::function<RowNotes(RowSink&)>& read) {
  Table table;
  TableSink sink(table);
  static_cast<RowNotes&>(table) = read(sink);
  return table;
}

inline Table read_table(InputFile& file, const CsvLayout& layout = {}) {
  return table_of([&](RowSink& sink) { return read_csv_rows(file, layout, sink); });
}

// Throws std::runtime_error with one line: no rate, a reference without its rate.
inline Capture capture_of(Table table, const std::string& path) {
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

// The same for a driver's samples, without axes and channels that never have a value.
inline Capture known_part_of(Table table, const std::string& path) {
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

inline Capture read_capture(const std::string& path) {
  InputFile file(path);
  return capture_of(read_table(file), path);
}
// The same for a text; `path` names it in messages.
inline Capture parse_capture(std::string_view text, const std::string& path, const CsvLayout& layout = {}) {
  InputFile file(path, std::string(text));
  return capture_of(read_table(file, layout), path);
}

// What a text is refused with, or "accepted".
inline std::string refusal_of(const std::string& text, const CsvLayout& layout = {}) {
  return test::refusal([&] { parse_capture(text, "a.csv", layout); });
}

// A row for each of `rows`: what stands before, between and behind the rates, {i} being the row's number and
// {x}, {y}, {z} white noise of 0.001.
inline std::string rows_of(const std::string& head, const std::string& form, int rows = 40) {
  std::string text = head;
  std::uint32_t dice = 1;
  for (int i = 0; i < rows; ++i) {
    std::string row = form;
    const auto put = [&row](const std::string& name, const std::string& value) {
      for (std::size_t at; (at = row.find(name)) != std::string::npos;) row.replace(at, name.size(), value);
    };
    for (const char* axis : {"{x}", "{y}", "{z}"}) {
      dice = dice * 1664525U + 1013904223U;
      put(axis, std::to_string(1e-3 * (static_cast<double>(dice >> 16U) / 32768.0 - 1.0)));
    }
    put("{count}", std::to_string(static_cast<int>(dice >> 20U) - 2048));
    put("{angle}", std::to_string(3.0 + 1e-3 * i));
    put("{digit}", std::to_string(7 * i % 10));
    put("{i}", std::to_string(100 + i));
    text += row + "\n";
  }
  return text;
}

namespace test {

// A builder whose rows become a capture.
struct Built : private Table, private TableSink, CaptureBuilder {
  explicit Built(const ifog_description& description, const std::vector<std::string>& outside = {})
      : TableSink(static_cast<Table&>(*this)),
        CaptureBuilder(description, static_cast<RowSink&>(*this), outside) {}
  Capture finish() {
    CaptureBuilder::finish();
    return known_part_of(std::move(static_cast<Table&>(*this)), "");
  }
};

}  // namespace test
}  // namespace ifog
