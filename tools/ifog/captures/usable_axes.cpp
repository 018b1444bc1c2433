// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/usable_axes.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <stdexcept>

#include "drivers/capture/column_names.h"
#include "drivers/ifog/quoted.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

std::string rate_of(const std::string& axis) { return axis.empty() ? "rate" : "rate_" + axis; }

void tell_missing(const std::string& name, const std::string& axis, std::span<const double> time_s,
                  std::span<const double> rate) {
  const auto none = [](double value) { return std::isnan(value); };
  const auto missing = static_cast<std::size_t>(std::count_if(rate.begin(), rate.end(), none));
  if (missing == 0) return;
  const auto first = static_cast<std::size_t>(std::find_if(rate.begin(), rate.end(), none) - rate.begin());
  warn("%s: %s\n", name.c_str(),
       missing_in_words(rate_of(axis), missing, rate.size(), time_s[first]).c_str());
}

bool has_value(std::span<const double> values) {
  return std::any_of(values.begin(), values.end(), [](double value) { return !std::isnan(value); });
}

void leave_out(CaptureView& capture, const std::string& axis) {
  const auto found = std::find(capture.axes.begin(), capture.axes.end(), axis);
  if (found == capture.axes.end()) return;
  const auto at = found - capture.axes.begin();
  capture.axes.erase(found);
  capture.rate_radps.erase(capture.rate_radps.begin() + at);
  capture.reference_rate_radps.erase(capture.reference_rate_radps.begin() + at);
}

void keep_usable(std::span<CaptureView> captures, std::span<const std::string> names) {
  std::vector<std::string> dead;
  for (std::size_t c = 0; c < captures.size(); ++c) {
    const CaptureView& capture = captures[c];
    std::size_t alive = 0;
    for (std::size_t a = 0; a < capture.axes.size(); ++a) {
      if (has_value(capture.rate_radps[a])) {
        ++alive;
        tell_missing(names[c], capture.axes[a], capture.time_s, capture.rate_radps[a]);
      } else {
        dead.push_back(capture.axes[a]);
      }
    }
    if (alive == 0) refuse_without_rates(names[c], capture.size());
    for (const std::string& axis : std::span(dead).last(capture.axes.size() - alive))
      tell_left_out(names[c], rate_of(axis), capture.size());
  }
  for (CaptureView& capture : captures) {
    for (const std::string& axis : dead) leave_out(capture, axis);
    if (capture.axes.empty()) refuse_without_rates(names.front(), capture.size());
  }
}

}  // namespace

std::string missing_in_words(const std::string& column, std::size_t missing, std::size_t rows,
                             double first_s) {
  if (missing == 0) return "";
  char first[32];
  std::snprintf(first, sizeof first, "%.10g", first_s);
  return column + " is missing in " + std::to_string(missing) + " of " + std::to_string(rows) +
         " rows, first at " + first + " s";
}

void tell_left_out(const std::string& name, const std::string& column, std::size_t rows) {
  warn("%s: %s is missing in all %zu rows: the axis is left out\n", name.c_str(), column.c_str(), rows);
}

std::string expected_axes(const std::vector<std::string>& axes) {
  if (axes == std::vector<std::string>{""}) return "none, the capture has one axis";
  std::string list;
  for (const std::string& axis : axes) list += (list.empty() ? "" : ", ") + in_quotes(axis);
  return "one of " + list;
}

void refuse_without_rates(const std::string& name, std::size_t rows) {
  throw std::runtime_error(name + ": no axis has a value in any of " + std::to_string(rows) +
                           " rows, expected rates");
}

void keep_usable_axes(std::vector<CaptureView>& captures, const std::vector<std::string>& names) {
  keep_usable(std::span(captures), names);
}

void keep_usable_axes(CaptureView& capture, const std::string& name) {
  keep_usable(std::span(&capture, 1), {&name, 1});
}

void keep_usable_axes(LongTable& table, const std::string& name) {
  std::string axis;
  std::size_t rates = 0, alive = 0;
  for (const LongColumn& column : table.columns)
    if (axis_of(column.name, "rate", axis)) {
      ++rates;
      alive += column.known ? 1 : 0;
    }
  if (rates > 0 && alive == 0) refuse_without_rates(name, table.size());
  std::vector<std::string> dead;
  std::erase_if(table.columns, [&](const LongColumn& column) {
    if (!axis_of(column.name, "rate", axis) || column.known) return false;
    tell_left_out(name, rate_of(axis), table.size());
    dead.push_back(axis);
    return true;
  });
  std::erase_if(table.columns, [&](const LongColumn& column) {
    return axis_of(column.name, "reference_rate", axis) &&
           std::find(dead.begin(), dead.end(), axis) != dead.end();
  });
}

}  // namespace ifog::tools
