// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/checks/row_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/ifog/driver.h"
#include "drivers/ifog/quoted.h"
#include "drivers/row_times/sample_clock.h"
#include "drivers/units/turn.h"

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

// Converts an angle to the mean rate since the previous row; the first row has none. An angle that stays
// within one turn wraps by a turn and changes by less than half a turn per row; after a gap its change is
// unknown.
std::vector<double> derivative(std::vector<double> angle_rad, const std::vector<double>& time_s) {
  const auto known = [](double value) { return !std::isnan(value); };
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const double angle : angle_rad) {
    if (!known(angle)) continue;
    least = std::min(least, angle);
    most = std::max(most, angle);
  }
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const bool wraps = most - least <= kTurn * (1.0 + 1e-9);
  constexpr double kGap = 1.5;  // of the shortest step
  double before = kMissing, since_s = 0.0, rate_before = 0.0,
         shortest_s = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < angle_rad.size(); ++i) {
    const double angle = angle_rad[i];
    const double turned = wraps ? std::remainder(angle - before, kTurn) : angle - before;
    const double step_s = time_s[i] - since_s;
    if (known(before)) shortest_s = std::min(shortest_s, step_s);
    const bool known_turn =
        !wraps || step_s <= kGap * shortest_s || turn_is_known(rate_before, step_s, kTurn);
    angle_rad[i] = known_turn ? turned / step_s : kMissing;
    if (!known(angle)) continue;
    rate_before = known(angle_rad[i]) ? angle_rad[i] : 0.0;
    before = angle;
    since_s = time_s[i];
  }
  return angle_rad;
}

// Mean square of the changes from value to value.
double roughness(const std::vector<double>& values) {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double change = values[i] - values[i - 1];
    if (!std::isnan(change)) sum += change * change, count += 1.0;
  }
  return sum / count;
}

// Converts to the capture's units; angles stay in rad until as_rates().
void convert(RowBlock& rows, const std::vector<FileColumn>& columns) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const UnitConversion conversion = columns[i].conversion();
    if (conversion.scale == 1.0 && conversion.offset == 0.0) continue;
    for (double& value : rows.columns[i]) value = value * conversion.scale + conversion.offset;
  }
}

// Needs all rows, to find out whether an angle stays within one turn.
void as_rates(RowBlock& all, const std::vector<FileColumn>& columns, const RowNotes& notes) {
  if (all.size() < 2) {
    for (std::size_t i = 0; i < columns.size(); ++i)
      if (columns[i].angle_rad()) std::ranges::fill(all.columns[i], kMissing);
    return;
  }
  const SampleClock clock = sample_clock(all.time_s);
  RowTimes times(all.time_s, clock);
  std::vector<double> even_s;
  for (const double stamp_s : all.time_s) even_s.push_back(times.next(stamp_s));
  std::vector<double> interval_s(all.size(), clock.period_s);
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].name == kInterval) interval_s = all.columns[i];
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const FileColumn& column = columns[i];
    if (!column.angle_rad()) continue;
    std::vector<double>& values = all.columns[i];
    if (column.unit.ends_with("/sample")) {
      for (std::size_t row = 0; row < values.size(); ++row)
        values[row] = interval_s[row] > 0.0 ? values[row] / interval_s[row] : kMissing;
    } else {
      // Either the samples are uneven or only their stamps, as those in ticks: with the wrong times the rates are rougher.
      std::vector<double> by_even = derivative(values, even_s);
      values = derivative(std::move(values), all.time_s);
      if (roughness(by_even) < roughness(values)) values = std::move(by_even);
    }
    // A glitch of an angle gives two outliers, and the wrong cell is ambiguous.
    for (std::size_t row = 0; row < values.size(); ++row)
      if (std::abs(values[row]) > IFOG_MAX_RATE)
        notes.refuse(notes.line_of_row(row), printable(column.header) + " has turned at " +
                                                 shortest(values[row]) +
                                                 " rad/s since the row before, which no sensor measures");
  }
}

}  // namespace

std::string what_no_sensor_measures(const std::string& name, std::string_view cell, const Measurable& range) {
  return printable(name) + " is " + in_quotes(cell) + ", which no sensor measures, expected " +
         shortest(range.least) + " to " + shortest(range.most);
}

RowChecks::RowChecks(const CsvLayout& layout, std::vector<FileColumn> columns, RowSink& sink, RowNotes& notes)
    : columns_(std::move(columns)),
      sink_(sink),
      notes_(notes),
      clock_(layout.time.value_or(CsvTime{}).header, layout.keep_repeats, notes,
             [this](RowBlock& rows) { behind_clock(rows); }) {
  if (std::ranges::any_of(columns_, [](const auto& column) { return column.angle_rad().has_value(); }))
    all_.emplace();
}

void RowChecks::take(RowBlock& rows) {
  convert(rows, columns_);
  rows_ += rows.size();
  clock_.take(rows);
}

void RowChecks::behind_clock(RowBlock& rows) {
  notes_.add_lines(given_, rows);
  given_ += rows.size();
  rate_.take(rows);
  if (!all_) return sink_.take(rows);
  all_->append(rows);
}

void RowChecks::finish(std::span<const Fault> found) {
  for (std::size_t c = 0; c < columns_.size(); ++c) tell_impossible(columns_[c], found[c]);
  clock_.finish();
  if (const std::string change = rate_.change_in_words(); !change.empty()) notes_.notice(0, change);
  if (!all_) return;
  as_rates(*all_, columns_, notes_);
  sink_.take(*all_);
}

void RowChecks::tell_impossible(const FileColumn& column, const Fault& found) {
  if (found.count == 0) return;
  const std::string what = what_no_sensor_measures(column.cell, found.first, column.range);
  const bool few = found.count == 1 || kRowsAFault * found.count <= rows_;
  if (is_rate_column(column.name) && (rows_ == 1 || !few)) {
    std::string more =
        found.count > 1 ? "; nor " + std::to_string(found.count - 1) + " more of its cells" : "";
    if (found.first.find_first_not_of("+-0123456789") == std::string::npos)
      more += "; counts are read by their scale: --column 'rate_x_radps=" + printable(column.cell) +
              ":0.00763deg/s'";
    notes_.refuse(found.line, what + more);
  }
  notes_.fault(found.line, what + "; " + std::to_string(found.count) +
                               (found.count == 1 ? " such cell" : " such cells") + " treated as missing");
}

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
