// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/compare/compare_picture.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "filters/allan/deviation.h"
#include "filters/allan/stretches.h"
#include "filters/units/field_units.h"
#include "tools/report/picture.h"
#include "tools/report/plot_data.h"
#include "tools/report/time_axis.h"

namespace ifog::tools {
namespace {

using report::Chart;
using report::ChartAxis;
using report::Role;

struct AllanCurve {
  std::vector<double> tau_s, sigma;  // sigma in °/h
};

AllanCurve allan(const CaptureView& capture, std::span<const double> rate, const SampleClock& clock) {
  AllanCurve curve;
  const std::vector<Stretch> whole = stretches(capture.time_s, rate, clock);
  if (whole.empty()) return curve;
  const AngleSum sum(rate, whole);
  for (const DeviationPoint& point : deviation(sum, log_spaced(sum.longest() / 4, 6))) {
    if (point.terms == 0 || !(point.variance > 0.0)) continue;
    curve.tau_s.push_back(static_cast<double>(point.m) * clock.period_s);
    curve.sigma.push_back(std::sqrt(point.variance) / kDegreePerHour);
  }
  return curve;
}

// A curve in the units that it is shown in, in no more points than are drawn.
report::Thinned drawn(const CaptureView& capture, const report::TimeAxis& axis,
                      std::span<const double> rate_radps) {
  Samples time(capture.time_s), rate(rate_radps);
  for (double& t : time) t = axis(capture.origin.told(t));
  for (double& r : rate) r *= 1.0 / kDegreePerHour;
  return report::thinned(time, rate);
}

// What the differences keep to once the filters have started, in °/h: the first twentieth and the outermost two
// in a thousand values left out, with a margin. None: no number among them.
void keep_range(ChartAxis& axis, const std::vector<Samples>& differences_radps) {
  Samples values;
  for (const Samples& difference : differences_radps)
    for (std::size_t i = difference.size() / 20; i < difference.size(); ++i)
      if (std::isfinite(difference[i])) values.push_back(difference[i] * (1.0 / kDegreePerHour));
  if (values.empty()) return;
  const std::size_t cut = values.size() / 1000;
  const auto nth = [&](std::size_t n) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(n), values.end());
    return values[n];
  };
  const double low = nth(cut), high = nth(values.size() - 1 - cut);
  const double margin = std::max(0.1 * (high - low), 1e-9);
  axis.low = low - margin;
  axis.high = high + margin;
}

// Of the curve over another's, at the averaging times of both.
AllanCurve over(const AllanCurve& curve, const AllanCurve& other) {
  AllanCurve out;
  for (std::size_t i = 0, j = 0; i < curve.tau_s.size(); ++i) {
    while (j < other.tau_s.size() && other.tau_s[j] < curve.tau_s[i]) ++j;
    if (j == other.tau_s.size() || other.tau_s[j] != curve.tau_s[i]) continue;
    out.tau_s.push_back(curve.tau_s[i]);
    out.sigma.push_back(curve.sigma[i] / other.sigma[j]);
  }
  return out;
}

// The rows of one axis of the sensor: raw, the best rule, and what the others differ from that.
void add_rows(std::vector<report::PictureRow>& rows, const CaptureView& capture, const Comparison& result,
              const std::vector<std::string>& rules, std::size_t axis, std::size_t best) {
  constexpr double kRow = 132.0, kNumbers = 38.0;
  const std::string prefix = capture.axes[axis].empty() ? "" : "axis " + capture.axes[axis] + ": ";
  const report::TimeAxis time(capture.told_time_s(0), capture.told_time_s(capture.size() - 1));
  const SampleClock clock = sample_clock(capture.time_s);
  const Samples& of_best = result.denoised[best][axis];
  const AllanCurve raw_allan = allan(capture, capture.rate_radps[axis], clock),
                   best_allan = allan(capture, of_best, clock);
  const auto rate_chart = [&](const std::string& title, Role role, std::span<const double> rate_radps,
                              const ChartAxis& range, bool last) {
    Chart chart(prefix + title, "Rate over time.", time.axis(last), range);
    const report::Thinned curve = drawn(capture, time, rate_radps);
    chart.line_in_time(role, "", curve.x, curve.y);
    return chart;
  };
  const auto allan_chart = [&](const std::string& title, const AllanCurve* grey, const AllanCurve& curve,
                               const ChartAxis& range, bool last) {
    ChartAxis tau{last ? "averaging time τ (s)" : "", true, {}, {}};
    tau.numbered = last;
    if (!raw_allan.tau_s.empty()) {
      tau.low = raw_allan.tau_s.front();
      tau.high = raw_allan.tau_s.back();
    }
    Chart chart(title, "Allan deviation over averaging time.", tau, range);
    if (grey != nullptr) chart.line(Role::kRaw, "", grey->tau_s, grey->sigma);
    chart.line(Role::kAfter, "", curve.tau_s, curve.sigma);
    return chart;
  };
  const ChartAxis own{"°/h", false, {}, {}}, sigma{"°/h", true, {}, {}};
  rows.push_back(
      {kRow,
       {{rate_chart("raw", Role::kRaw, capture.rate_radps[axis], own, false), 2.0},
        {allan_chart(rules[best] + " and raw (grey), Allan deviation", &raw_allan, best_allan, sigma, false),
         1.0}}});
  ChartAxis settled = own, apart{"°/h", false, {}, {}}, ratio{"ratio", false, {}, {}};
  std::vector<Samples> differences(1, of_best);
  keep_range(settled, differences);
  differences.clear();
  std::vector<AllanCurve> ratios;
  report::Bounds bounds;
  for (std::size_t r = 0; r < rules.size(); ++r) {
    differences.push_back(result.denoised[r][axis]);
    for (std::size_t i = 0; i < of_best.size(); ++i) differences[r][i] -= of_best[i];
    ratios.push_back(over(allan(capture, result.denoised[r][axis], clock), best_allan));
    for (const double each : ratios[r].sigma) bounds.take(each, true);
  }
  keep_range(apart, differences);
  if (!bounds.empty()) {
    ratio.low = std::min(bounds.low / 1.05, 0.9);
    ratio.high = std::max(bounds.high * 1.05, 1.1);
  }
  const AllanCurve one{best_allan.tau_s, std::vector<double>(best_allan.tau_s.size(), 1.0)};
  rows.push_back({kRow,
                  {{rate_chart(rules[best] + ", the best", Role::kAfter, of_best, settled, false), 2.0},
                   {Chart("", "", own, own), 1.0}}});
  for (std::size_t r = 0, drawn_rows = 1; r < rules.size(); ++r) {
    if (r == best) continue;
    const bool last = ++drawn_rows == rules.size();
    rows.push_back(
        {last ? kRow + kNumbers : kRow,
         {{rate_chart(rules[r] + " less " + rules[best], Role::kBefore, differences[r], apart, last), 2.0},
          {allan_chart(rules[r] + " over " + rules[best] + ", Allan deviation", &one, ratios[r], ratio, last),
           1.0}}});
  }
}

}  // namespace

void draw_comparison(const std::string& path, const CaptureView& capture, const Comparison& result,
                     const std::vector<std::string>& rules, const std::vector<Verdict>& verdicts) {
  std::vector<report::PictureRow> rows;
  std::string title;
  for (std::size_t a = 0; a < capture.axes.size(); ++a) {
    add_rows(rows, capture, result, rules, a, verdicts[a].best);
    title += (title.empty() ? "" : "; ") + (capture.axes[a].empty() ? "" : capture.axes[a] + ": ") +
             (capture.axes.size() == 1 ? verdicts[a].text : "best is " + rules[verdicts[a].best]);
  }
  report::write_picture(path, report::picture_svg(title, rows, 1100.0));
}

}  // namespace ifog::tools
