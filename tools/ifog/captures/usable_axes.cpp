// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/usable_axes.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "drivers/capture/columns/column_names.h"
#include "drivers/ifog/quoted.h"
#include "filters/units/told_time.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

std::string rate_of(const std::string& axis) { return axis.empty() ? "rate" : "rate_" + axis; }

void tell_missing(const std::string& name, const std::string& axis, const CaptureView& capture,
                  std::span<const double> rate) {
  const auto none = [](double value) { return std::isnan(value); };
  const auto missing = static_cast<std::size_t>(std::ranges::count_if(rate, none));
  if (missing == 0) return;
  const auto first = static_cast<std::size_t>(std::find_if(rate.begin(), rate.end(), none) - rate.begin());
  warn("{}: {}\n", name, missing_in_words(rate_of(axis), missing, rate.size(), capture.shown_time_s(first)));
}

bool has_value(std::span<const double> values) {
  return std::any_of(values.begin(), values.end(), [](double value) { return !std::isnan(value); });
}

// As many as in filters/chain/sensor_check.h: coarse values also repeat.
bool repeats_one_value(std::span<const double> values) {
  constexpr std::ptrdiff_t kFewest = 100;
  const auto is_value = [](double value) { return !std::isnan(value); };
  const auto first = std::find_if(values.begin(), values.end(), is_value);
  return std::all_of(first, values.end(),
                     [&](double value) { return !is_value(value) || value == *first; }) &&
         std::count_if(first, values.end(), is_value) > kFewest;
}

void tell_stuck(const std::string& name, const std::string& axis, std::span<const double> rate) {
  const double value = *std::find_if(rate.begin(), rate.end(), [](double v) { return !std::isnan(v); });
  warn("{}: {} is {:.6g} rad/s in all of its {} rows: the axis is stuck, and dropped\n", name, rate_of(axis),
       value, rate.size());
}

// Unusable axes of one capture.
std::vector<std::string> unusable(const CaptureView& capture, const std::string& name) {
  std::vector<std::string> missing, stuck;
  for (std::size_t a = 0; a < capture.axes.size(); ++a)
    if (!has_value(capture.rate_radps[a]))
      missing.push_back(capture.axes[a]);
    else if (repeats_one_value(capture.rate_radps[a]))
      stuck.push_back(capture.axes[a]);
  if (missing.size() == capture.axes.size()) refuse_without_rates(name, capture.size());
  // If no other axis is left, the command reports the stuck ones itself.
  if (missing.size() + stuck.size() == capture.axes.size()) stuck.clear();
  const auto is_in = [](const std::vector<std::string>& axes, const std::string& axis) {
    return std::find(axes.begin(), axes.end(), axis) != axes.end();
  };
  for (std::size_t a = 0; a < capture.axes.size(); ++a) {
    const std::string& axis = capture.axes[a];
    if (is_in(missing, axis))
      tell_left_out(name, rate_of(axis), capture.size());
    else if (is_in(stuck, axis))
      tell_stuck(name, axis, capture.rate_radps[a]);
    else
      tell_missing(name, axis, capture, capture.rate_radps[a]);
  }
  missing.insert(missing.end(), stuck.begin(), stuck.end());
  return missing;
}

}  // namespace

std::string missing_in_words(const std::string& column, std::size_t missing, std::size_t rows,
                             double first_s) {
  if (missing == 0) return "";
  return column + " is missing in " + std::to_string(missing) + " of " + std::to_string(rows) +
         " rows, first at " + told_time(first_s) + " s";
}

void tell_left_out(const std::string& name, const std::string& column, std::size_t rows) {
  warn("{}: {} is missing in all {} rows: the axis is dropped\n", name, column, rows);
}

std::string expected_axes(const std::vector<std::string>& axes) {
  if (axes == std::vector<std::string>{""}) return "none, the capture has one axis";
  std::string list;
  for (const std::string& axis : axes) list += (list.empty() ? "" : ", ") + in_quotes(axis);
  return "one of " + list;
}

void refuse_without_rates(const std::string& name, std::size_t rows) {
  throw refusal("{}: no axis has a value in any of {} rows, expected rates", name, rows);
}

std::vector<std::string> unusable_axes(const std::vector<CaptureView>& captures,
                                       const std::vector<std::string>& names) {
  std::vector<std::string> all;
  for (std::size_t c = 0; c < captures.size(); ++c)
    for (std::string& axis : unusable(captures[c], names[c]))
      if (std::find(all.begin(), all.end(), axis) == all.end()) all.push_back(std::move(axis));
  for (std::size_t c = 0; c < captures.size(); ++c) {
    CaptureView left = captures[c];
    leave_out(all, left);
    if (left.axes.empty()) throw refusal("{}: no axis is left that can be used in every capture", names[c]);
  }
  return all;
}

void leave_out(const std::vector<std::string>& axes, CaptureView& capture) {
  for (const std::string& axis : axes) {
    const auto found = std::find(capture.axes.begin(), capture.axes.end(), axis);
    if (found == capture.axes.end()) continue;
    const auto at = found - capture.axes.begin();
    capture.axes.erase(found);
    capture.rate_radps.erase(capture.rate_radps.begin() + at);
    capture.reference_rate_radps.erase(capture.reference_rate_radps.begin() + at);
    capture.dead_axes.push_back(axis);
  }
}

void leave_out_dead_axes(LongTable& table, const std::string& name) {
  std::string axis;
  std::size_t rates = 0, alive = 0;
  for (const LongColumn& column : table.columns)
    if (axis_of(column.name, "rate", axis)) {
      ++rates;
      alive += column.known ? 1 : 0;
    }
  if (rates > 0 && alive == 0) refuse_without_rates(name, table.size());
  for (const std::string& dead : table.drop_dead_axes()) tell_left_out(name, rate_of(dead), table.size());
}

}  // namespace ifog::tools
