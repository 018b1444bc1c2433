// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/usable_axes.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "drivers/capture/columns/column_names.h"
#include "filters/units/told_time.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

struct RateValues {
  std::size_t values = 0, missing = 0, first_missing = 0;
  double first = 0.0;
  bool repeats = true;  // the first value

  // As many as in filters/chain/sensor_check.h: coarse values also repeat.
  [[nodiscard]] bool stuck() const { return repeats && values > 100; }
};

RateValues values_of(std::span<const double> rate) {
  RateValues out;
  for (std::size_t i = 0; i < rate.size(); ++i) {
    if (std::isnan(rate[i])) {
      if (out.missing++ == 0) out.first_missing = i;
      continue;
    }
    if (out.values++ == 0) out.first = rate[i];
    out.repeats = out.repeats && rate[i] == out.first;
  }
  return out;
}

// Unusable axes of one capture.
std::vector<std::string> unusable(const CaptureView& capture, const std::string& name) {
  std::vector<RateValues> axes;
  for (const std::span<const double> rate : capture.rate_radps) axes.push_back(values_of(rate));
  const auto dead = std::ranges::count(axes, 0U, &RateValues::values);
  if (dead == std::ssize(axes)) refuse_without_rates(name, capture.size());
  // If no other axis is left, the command reports the stuck ones itself.
  const bool others = dead + std::ranges::count_if(axes, &RateValues::stuck) < std::ssize(axes);
  std::vector<std::string> out;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const std::string column = of_axis("rate", capture.axes[a]);
    if (axes[a].values == 0) {
      tell_left_out(name, column, capture.size());
    } else if (axes[a].stuck() && others) {
      warn("{}: {} is {:.6g} rad/s in all of its {} rows: the axis is stuck, and dropped\n", name, column,
           axes[a].first, capture.size());
    } else {
      if (axes[a].missing > 0)
        warn("{}: {}\n", name,
             missing_in_words(column, axes[a].missing, capture.size(),
                              capture.shown_time_s(axes[a].first_missing)));
      continue;
    }
    out.push_back(capture.axes[a]);
  }
  return out;
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
  return "one of " + listed(axes);
}

void refuse_without_rates(const std::string& name, std::size_t rows) {
  throw refusal("{}: no axis has a value in any of {} rows, expected rates", name, rows);
}

std::vector<std::string> unusable_axes(const std::vector<CaptureView>& captures,
                                       const std::vector<std::string>& names) {
  std::vector<std::string> all;
  for (std::size_t c = 0; c < captures.size(); ++c)
    for (std::string& axis : unusable(captures[c], names[c]))
      if (std::ranges::find(all, axis) == all.end()) all.push_back(std::move(axis));
  for (std::size_t c = 0; c < captures.size(); ++c) {
    CaptureView left = captures[c];
    leave_out(all, left);
    if (left.axes.empty()) throw refusal("{}: no axis is left that can be used in every capture", names[c]);
  }
  return all;
}

void leave_out(const std::vector<std::string>& axes, CaptureView& capture) {
  for (const std::string& axis : axes) {
    const auto found = std::ranges::find(capture.axes, axis);
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
  for (const std::string& dead : table.drop_dead_axes())
    tell_left_out(name, of_axis("rate", dead), table.size());
}

}  // namespace ifog::tools
