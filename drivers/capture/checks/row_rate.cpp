// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/checks/row_rate.h"

#include <cmath>
#include <numeric>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/times/time_stamps.h"

namespace ifog {
namespace {

constexpr std::size_t kWindow = 256;   // rows
constexpr std::ptrdiff_t kFewest = 8;  // windows at each rate; fewer may be a device that starts
constexpr double kOther = 0.01;        // of the rate
constexpr double kTimesScatter = 8.0;  // of the windows' periods; less is a rate that wanders
constexpr double kLongStep = 1.5;      // of the usual step; rows are missing in longer ones

double mean_without_gaps(const std::vector<double>& time_s) {
  const double longest_s = kLongStep * median_step_s(time_s);
  double sum_s = 0.0, steps = 0.0;
  for (std::size_t i = 1; i < time_s.size(); ++i)
    if (const double step_s = time_s[i] - time_s[i - 1]; step_s <= longest_s) sum_s += step_s, steps += 1.0;
  return sum_s / steps;
}

}  // namespace

void RowRate::take(const RowBlock& rows) {
  origin_ = rows.origin;
  for (const double time : rows.time_s) {
    times_.push_back(time);
    if (times_.size() <= kWindow) continue;
    begins_s_.push_back(times_.front());
    period_s_.push_back(mean_without_gaps(times_));
    times_ = {time};
  }
}

// The change is where the sum of departures from the mean is largest (E. S. Page, 1954).
std::string RowRate::change_in_words() const {
  const std::ptrdiff_t windows = std::ssize(period_s_);
  if (windows < 2 * kFewest) return "";
  const double mean_s =
      std::accumulate(period_s_.begin(), period_s_.end(), 0.0) / static_cast<double>(windows);
  double sum_s = 0.0, most_s = -1.0;
  auto change = period_s_.begin();
  for (auto window = change; window != period_s_.end(); ++window) {
    if (std::abs(sum_s) > most_s && window - period_s_.begin() >= kFewest &&
        period_s_.end() - window >= kFewest)
      change = window, most_s = std::abs(sum_s);
    sum_s += *window - mean_s;
  }
  const double before_s = median({period_s_.begin(), change}), after_s = median({change, period_s_.end()});
  std::vector<double> away_s;
  for (auto window = period_s_.begin(); window != period_s_.end(); ++window)
    away_s.push_back(std::abs(*window - (window < change ? before_s : after_s)));
  const double step_s = std::abs(after_s - before_s);
  if (step_s < kOther * before_s || step_s < kTimesScatter * median(std::move(away_s))) return "";
  const auto hz = [](double period_s) { return shortest(std::round(1e4 / period_s) / 1e4); };
  std::string text = "rows come at " + hz(before_s) + " Hz until ";
  append_time(text, origin_,
              std::round(1e3 * begins_s_[static_cast<std::size_t>(change - period_s_.begin())]) / 1e3);
  return text + " s and at " + hz(after_s) +
         " Hz from there on: no rate is right for both; --from and --to choose one";
}

}  // namespace ifog
