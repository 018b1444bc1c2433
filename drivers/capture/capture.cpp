// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/capture.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "drivers/capture/column_names.h"
#include "drivers/capture/text_file.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

void append(std::string& out, double value) {
  if (std::isnan(value)) {
    out += "nan";
    return;
  }
  std::array<char, 40> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  (void)error;  // 40 characters hold any double
  out.append(text.data(), end);
}

std::vector<std::string> names_of(const Table& table) {
  std::vector<std::string> names{"time_s"};
  for (const CaptureColumn& column : table.columns) names.push_back(column.name);
  return names;
}

}  // namespace

Capture read_capture(const std::string& path) { return parse_capture(read_text_file(path), path); }

Capture parse_capture(std::string_view text, const std::string& path, const CsvLayout& layout) {
  Table table = parse_table(text, path, layout);
  Capture capture;
  capture.notices = std::move(table.notices);
  capture.faults = std::move(table.faults);
  capture.comments = std::move(table.comments);
  capture.time_s = std::move(table.time_s);
  std::string axis;
  for (const CaptureColumn& column : table.columns)
    if (axis_of(column.name, "rate", axis)) capture.axes.push_back(axis);
  if (capture.axes.empty())
    refuse_header(path, table.header_line, "no rate column, expected 'rate_radps' or 'rate_x_radps', …",
                  names_of(table));
  capture.rate_radps.resize(capture.axes.size());
  capture.reference_rate_radps.resize(capture.axes.size());
  const auto index_of = [&](const std::string& name) {
    for (std::size_t i = 0; i < capture.axes.size(); ++i)
      if (capture.axes[i] == name) return i;
    fail_at(path, table.header_line,
            "reference column of axis " + in_quotes(name) + " has no rate column beside it");
  };
  for (CaptureColumn& column : table.columns) {
    if (axis_of(column.name, "rate", axis))
      capture.rate_radps[index_of(axis)] = std::move(column.values);
    else if (axis_of(column.name, "reference_rate", axis))
      capture.reference_rate_radps[index_of(axis)] = std::move(column.values);
    else
      capture.channels.push_back(std::move(column));
  }
  return capture;
}

void write_capture(const Capture& capture, const std::string& path) {
  std::vector<std::pair<std::string, const std::vector<double>*>> columns;
  columns.emplace_back("time_s", &capture.time_s);
  const auto named = [](const std::string& prefix, const std::string& axis) {
    return axis.empty() ? prefix + "_radps" : prefix + "_" + axis + "_radps";
  };
  for (std::size_t i = 0; i < capture.axes.size(); ++i)
    columns.emplace_back(named("rate", capture.axes[i]), &capture.rate_radps[i]);
  for (std::size_t i = 0; i < capture.reference_rate_radps.size(); ++i)
    if (!capture.reference_rate_radps[i].empty())
      columns.emplace_back(named("reference_rate", capture.axes[i]), &capture.reference_rate_radps[i]);
  for (const CaptureColumn& channel : capture.channels) columns.emplace_back(channel.name, &channel.values);

  std::string out;
  out.reserve(capture.size() * columns.size() * 16 + 256);
  for (const std::string& comment : capture.comments) out += "# " + comment + "\n";
  for (std::size_t c = 0; c < columns.size(); ++c) out += (c == 0 ? "" : ",") + columns[c].first;
  out += '\n';
  for (std::size_t row = 0; row < capture.size(); ++row) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (c != 0) out += ',';
      append(out, (*columns[c].second)[row]);
    }
    out += '\n';
  }
  write_text_file(path, out);
}

}  // namespace ifog
