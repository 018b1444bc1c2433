// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/table/long_table.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "drivers/capture/columns/column_names.h"
#include "filters/threads/share_out.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

bool is_rate(const std::string& column) {
  std::string axis;
  return axis_of(column, "rate", axis);
}

// By row: true if any rate has a value.
std::vector<bool> rows_with_rate(const LongTable& table) {
  std::vector<bool> with(table.size());
  for (const LongColumn& column : table.columns) {
    if (!is_rate(column.name)) continue;
    for (std::size_t i = 0; i < table.size(); ++i)
      if (!std::isnan(column.values[i])) with[i] = true;
  }
  return with;
}

// True if at least half of the rows with a rate have no neighbour with one.
bool stand_apart(const std::vector<bool>& with) {
  std::size_t rows = 0, apart = 0;
  for (std::size_t i = 0; i < with.size(); ++i) {
    if (!with[i]) continue;
    ++rows;
    apart += (i == 0 || !with[i - 1]) && (i + 1 == with.size() || !with[i + 1]) ? 1 : 0;
  }
  return rows > 2 && rows < with.size() && 2 * apart >= rows;
}

// latest: a row without a value gets the last one since the previous kept row.
Samples kept_of(std::span<const double> values, const std::vector<bool>& with, bool latest) {
  Samples kept;
  double last = kMissing;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!latest || !std::isnan(values[i])) last = values[i];
    if (!with[i]) continue;
    kept.push_back(last);
    last = kMissing;
  }
  return kept;
}

}  // namespace

std::vector<std::string> LongTable::names() const {
  std::vector<std::string> out;
  for (const LongColumn& column : columns) out.push_back(column.name);
  return out;
}

const LongColumn* LongTable::column(const std::string& name) const {
  const auto found = std::ranges::find(columns, name, &LongColumn::name);
  return found == columns.end() ? nullptr : &*found;
}

void LongTable::drop_unknown(const std::string& path) {
  const bool any = std::ranges::any_of(
      columns, [](const LongColumn& column) { return column.known && column.name.starts_with("rate"); });
  if (!any) throw refusal("{}: the device marks every value of every axis invalid", path);
  drop_dead_axes();
  std::erase_if(header, [&](const std::string& name) {
    const LongColumn* const found = column(name);
    return found != nullptr && !found->known;
  });
  std::erase_if(columns, [](const LongColumn& column) { return !column.known; });
}

void LongTable::clean(Rule rule) {
  const auto seconds = [&](std::size_t row) { return origin.in_s(time_s[row]); };
  share_out(columns.size(), std::thread::hardware_concurrency(), [&](std::size_t c) {
    std::string axis;
    if (axis_of(columns[c].name, "rate", axis)) rule(columns[c].values, seconds, columns[c].repeats);
  });
}

void LongTable::clean_and_tell(Rule rule, const std::string& path) {
  clean(rule);
  for (const LongColumn& column : columns)
    for (const ValueFault& repeat : column.repeats)
      warn("{}\n", faults.emplace_back(path + ": " + column.name + ": " + repeat.text));
}

std::vector<std::string> LongTable::drop_dead_axes() {
  std::vector<std::string> dead;
  std::string axis;
  const auto of_dead_axis = [&](const std::string& name) {
    return (axis_of(name, "rate", axis) || axis_of(name, "reference_rate", axis)) &&
           std::ranges::find(dead, axis) != dead.end();
  };
  for (const LongColumn& column : columns)
    if (!column.known && axis_of(column.name, "rate", axis)) dead.push_back(axis);
  std::erase_if(columns, [&](const LongColumn& column) { return of_dead_axis(column.name); });
  std::erase_if(header, of_dead_axis);
  dead_axes.insert(dead_axes.end(), dead.begin(), dead.end());
  return dead;
}

void LongTableSink::begin(const std::vector<std::string>& names) {
  table_.header = names;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (wanted_ && !wanted_(names[i])) {
      if (table_.outlined) table_.outlines.emplace_back(names[i]), outlined_.push_back(i);
      continue;
    }
    table_.columns.push_back({names[i], {}, false});
    from_.push_back(i);
  }
}

void LongTableSink::take(RowBlock& rows) {
  table_.origin = rows.origin;
  // Creating a file's pages takes longer than reading its rows: two threads share it.
  const unsigned threads = table_.time_s.has_room(rows.size()) ? 1 : 2;
  for (std::size_t i = 0; i < outlined_.size(); ++i) table_.outlines[i].add(rows.columns[outlined_[i]]);
  share_out(from_.size() + 1, threads, [&](std::size_t i) {
    if (i == 0) {
      table_.time_s.append(rows.time_s);
      return;
    }
    const std::size_t c = i - 1;
    LongColumn& column = table_.columns[c];
    const std::vector<double>& values = rows.columns[from_[c]];
    column.values.append(values);
    column.known = column.known || std::ranges::any_of(values, [](double v) { return !std::isnan(v); });
  });
}

LongTable long_table(Capture capture) {
  LongTable table;
  std::vector<std::string> names;
  RowBlock rows;
  rows.origin = capture.origin;
  rows.time_s = std::move(capture.time_s);
  const auto add = [&](const std::string& what, const std::string& axis, std::vector<double>& values) {
    if (values.empty()) return;
    names.push_back(of_axis(what, axis) + "_radps");
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

void LongTable::keep_rate_rows(const std::string& path) {
  if (std::ranges::none_of(columns, [](const LongColumn& column) { return is_rate(column.name); })) return;
  const std::vector<bool> with = rows_with_rate(*this);
  if (!stand_apart(with)) return;
  const std::size_t before = size();
  for (LongColumn& column : columns) column.values = kept_of(column.values, with, !is_rate(column.name));
  time_s = kept_of(time_s, with, false);
  outlines.clear();  // outlines of all rows are not valid for the rest
  // Line numbers apply to the rows of the file.
  header_line = 0;
  lines.clear();
  warn("{}: {} of {} rows have a rate, and only they are read: the others are of another sensor\n", path,
       size(), before);
}

}  // namespace ifog::tools
