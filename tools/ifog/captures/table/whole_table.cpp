// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/table/whole_table.h"

#include <string>
#include <utility>
#include <vector>

namespace ifog::tools {
namespace {

RowNotes hand_on(Capture capture, RowSink& sink) {
  std::vector<std::string> names;
  RowBlock rows;
  rows.origin = capture.origin;
  rows.time_s = std::move(capture.time_s);
  const auto add = [&](const std::string& what, const std::string& axis, std::vector<double>& values) {
    if (values.empty()) return;
    names.push_back(what + (axis.empty() ? "" : "_" + axis) + "_radps");
    rows.columns.push_back(std::move(values));
  };
  for (std::size_t i = 0; i < capture.axes.size(); ++i) {
    add("rate", capture.axes[i], capture.rate_radps[i]);
    add("reference_rate", capture.axes[i], capture.reference_rate_radps[i]);
  }
  for (CaptureColumn& channel : capture.channels) {
    names.push_back(channel.name);
    rows.columns.push_back(std::move(channel.values));
  }
  sink.begin(names);
  if (rows.size() > 0) sink.take(rows);
  RowNotes notes;
  for (const std::string& comment : capture.comments) notes.comments += comment + '\n';
  return notes;
}

}  // namespace

LongTable long_table(Capture capture) {
  LongTable table;
  LongTableSink sink(table);
  static_cast<RowNotes&>(table) = hand_on(std::move(capture), sink);
  return table;
}

LongTable long_table(Table whole) {
  LongTable table;
  LongTableSink sink(table);
  std::vector<std::string> names;
  RowBlock rows;
  rows.origin = whole.origin;
  rows.time_s = std::move(whole.time_s);
  for (CaptureColumn& column : whole.columns) {
    names.push_back(column.name);
    rows.columns.push_back(std::move(column.values));
  }
  static_cast<RowNotes&>(table) = std::move(whole);
  sink.begin(names);
  if (rows.size() > 0) sink.take(rows);
  return table;
}

}  // namespace ifog::tools
