// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "drivers/capture/columns/column_names.h"
#include "tools/ifog/captures/table/long_table.h"
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

void LongTable::keep_rate_rows(const std::string& path) {
  if (std::none_of(columns.begin(), columns.end(),
                   [](const LongColumn& column) { return is_rate(column.name); }))
    return;
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
