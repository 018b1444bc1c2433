// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/table/whole_table.h"

#include <string>
#include <utility>
#include <vector>

namespace ifog::tools {

LongTable long_table(Capture capture) {
  LongTable table;
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
  LongTableSink sink(table);
  sink.begin(names);
  if (rows.size() > 0) sink.take(rows);
  for (const std::string& comment : capture.comments) table.comments += comment + '\n';
  return table;
}

}  // namespace ifog::tools
