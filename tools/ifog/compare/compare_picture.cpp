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

// What a rate keeps to once its filter has started, in °/h: the first twentieth and the outermost two in a thousand values left
// out. Empty: no number among them.
report::Bounds settled(const Samples& rate_radps) {
  Samples values;
  for (std::size_t i = rate_radps.size() / 20; i < rate_radps.size(); ++i)
    if (std::isfinite(rate_radps[i])) values.push_back(rate_radps[i] * (1.0 / kDegreePerHour));
  report::Bounds out;
  if (values.empty()) return out;
  const std::size_t cut = values.size() / 1000;
  for (const std::size_t n : {cut, values.size() - 1 - cut}) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(n), values.end());
    out.take(values[n], false);
  }
  return out;
}

// With a margin.
ChartAxis axis_of(const report::Bounds& bounds) {
  ChartAxis axis{"°/h", false, {}, {}};
  if (bounds.empty()) return axis;
  const double margin = std::max(0.1 * (bounds.high - bounds.low), 1e-9);
  axis.low = bounds.low - margin;
  axis.high = bounds.high + margin;
  return axis;
}

// The curve over another's, at the averaging times of both.
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
class AxisRows {
 public:
  AxisRows(const CaptureView& capture, const Comparison& result, const std::vector<std::string>& rules,
           std::size_t axis, std::size_t best)
      : prefix_(capture.axes[axis].empty() ? "" : "axis " + capture.axes[axis] + ": "),
        best_(rules[best]),
        time_(capture.told_time_s(0), capture.told_time_s(capture.size() - 1)) {
    const SampleClock clock = sample_clock(capture.time_s);
    const Samples& of_best = result.denoised[best][axis];
    raw_ = {"raw", drawn(capture, time_, capture.rate_radps[axis]),
            allan(capture, capture.rate_radps[axis], clock)};
    of_best_ = {best_, drawn(capture, time_, of_best), allan(capture, of_best, clock)};
    best_range_ = settled(of_best);
    for (std::size_t r = 0; r < rules.size(); ++r) {
      if (r == best) continue;
      Samples difference = result.denoised[r][axis];
      for (std::size_t i = 0; i < of_best.size(); ++i) difference[i] -= of_best[i];
      others_.push_back({rules[r], drawn(capture, time_, difference),
                         over(allan(capture, result.denoised[r][axis], clock), of_best_.allan)});
      const report::Bounds range = settled(difference);
      range_.take(range.low, false);
      range_.take(range.high, false);
      for (const double each : others_.back().allan.sigma) ratios_.take(each, true);
    }
  }

  void add_to(std::vector<report::PictureRow>& rows) const {
    constexpr double kRow = 132.0, kNumbers = 38.0;
    const ChartAxis own{"°/h", false, {}, {}};
    rows.push_back({kRow,
                    {{rate_chart("raw", Role::kRaw, raw_, own, false), 2.0},
                     {allan_chart(best_ + " and raw (grey), Allan deviation", raw_.allan, of_best_.allan,
                                  {"°/h", true, {}, {}}, false),
                      1.0}}});
    rows.push_back(
        {kRow,
         {{rate_chart(best_ + ", the best", Role::kAfter, of_best_, axis_of(best_range_), false), 2.0},
          {Chart("", "", own, own), 1.0}}});
    ChartAxis ratio{"ratio", false, {}, {}};
    ratio.low = ratios_.empty() ? 0.9 : std::min(ratios_.low / 1.05, 0.9);
    ratio.high = ratios_.empty() ? 1.1 : std::max(ratios_.high * 1.05, 1.1);
    const AllanCurve one{of_best_.allan.tau_s, std::vector<double>(of_best_.allan.tau_s.size(), 1.0)};
    for (const Curves& other : others_) {
      const bool last = &other == &others_.back();
      rows.push_back(
          {last ? kRow + kNumbers : kRow,
           {{rate_chart(other.rule + " less " + best_, Role::kBefore, other, axis_of(range_), last), 2.0},
            {allan_chart(other.rule + " over " + best_ + ", Allan deviation", one, other.allan, ratio, last),
             1.0}}});
    }
  }

 private:
  struct Curves {
    std::string rule;
    report::Thinned rate;
    AllanCurve allan;
  };
  [[nodiscard]] Chart rate_chart(const std::string& title, Role role, const Curves& curves,
                                 const ChartAxis& range, bool last) const {
    Chart chart(prefix_ + title, "Rate over time.", time_.axis(last), range);
    chart.line_in_time(role, "", curves.rate.x, curves.rate.y);
    return chart;
  }
  [[nodiscard]] Chart allan_chart(const std::string& title, const AllanCurve& grey, const AllanCurve& curve,
                                  const ChartAxis& range, bool last) const {
    ChartAxis tau{last ? "averaging time τ (s)" : "", true, {}, {}};
    tau.numbered = last;
    if (!raw_.allan.tau_s.empty()) {
      tau.low = raw_.allan.tau_s.front();
      tau.high = raw_.allan.tau_s.back();
    }
    Chart chart(title, "Allan deviation over averaging time.", tau, range);
    chart.line(Role::kRaw, "", grey.tau_s, grey.sigma);
    chart.line(Role::kAfter, "", curve.tau_s, curve.sigma);
    return chart;
  }

  std::string prefix_, best_;
  report::TimeAxis time_;
  Curves raw_, of_best_;
  std::vector<Curves> others_;  // less the best, and over it
  report::Bounds best_range_, range_, ratios_;
};

}  // namespace

void draw_comparison(const std::string& path, const CaptureView& capture, const Comparison& result,
                     const std::vector<std::string>& rules, const std::vector<Verdict>& verdicts) {
  std::vector<report::PictureRow> rows;
  std::string title;
  for (std::size_t a = 0; a < capture.axes.size(); ++a) {
    AxisRows(capture, result, rules, a, verdicts[a].best).add_to(rows);
    title += (title.empty() ? "" : "; ") + (capture.axes[a].empty() ? "" : capture.axes[a] + ": ") +
             (capture.axes.size() == 1 ? verdicts[a].text
                                       : verdicts[a].text.substr(0, verdicts[a].text.find(':')));
  }
  report::write_picture(path, report::picture_svg(title, rows, 1100.0));
}

}  // namespace ifog::tools
