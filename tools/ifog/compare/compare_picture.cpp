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

// What the outputs keep to once their filters have started, in °/h: the first twentieth and the outermost two
// in a thousand values left out, with a margin. None: no number among them.
void keep_range(ChartAxis& axis, const std::vector<const Samples*>& outputs_radps) {
  Samples values;
  for (const Samples* const output : outputs_radps)
    for (std::size_t i = output->size() / 20; i < output->size(); ++i)
      if (std::isfinite((*output)[i])) values.push_back((*output)[i] * (1.0 / kDegreePerHour));
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

// The rows of one axis of the sensor.
class AxisRows {
 public:
  AxisRows(const CaptureView& capture, const Comparison& result, const std::vector<std::string>& rules,
           std::size_t axis)
      : rules_(rules),
        prefix_(capture.axes[axis].empty() ? "" : "axis " + capture.axes[axis] + ": "),
        time_(capture.told_time_s(0), capture.told_time_s(capture.size() - 1)),
        raw_(drawn(capture, time_, capture.rate_radps[axis])) {
    const SampleClock clock = sample_clock(capture.time_s);
    raw_allan_ = allan(capture, capture.rate_radps[axis], clock);
    std::vector<const Samples*> outputs;
    for (std::size_t r = 0; r < rules.size(); ++r) {
      outputs.push_back(&result.denoised[r][axis]);
      outputs_.push_back(drawn(capture, time_, *outputs.back()));
      allan_.push_back(allan(capture, *outputs.back(), clock));
    }
    keep_range(rate_, outputs);
    report::Bounds tau, sigma;
    const auto take = [&](const AllanCurve& curve) {
      for (const double t : curve.tau_s) tau.take(t, true);
      for (const double s : curve.sigma) sigma.take(s, true);
    };
    take(raw_allan_);
    for (const AllanCurve& curve : allan_) take(curve);
    if (tau.empty()) return;
    tau_.low = tau.low;
    tau_.high = tau.high;
    sigma_.low = sigma.low / 1.5;
    sigma_.high = sigma.high * 1.5;
  }

  void add_to(std::vector<report::PictureRow>& rows) const {
    constexpr double kRow = 132.0, kNumbers = 38.0;
    rows.push_back({kRow, {{raw_chart(), 2.0}, {allan_chart("raw", nullptr, false), 1.0}}});
    for (std::size_t r = 0; r < rules_.size(); ++r) {
      const bool last = r + 1 == rules_.size();
      Chart rate(prefix_ + rules_[r], "Denoised rate over time.", time_.axis(last), rate_);
      rate.line_in_time(Role::kAfter, "", outputs_[r].x, outputs_[r].y);
      rows.push_back({last ? kRow + kNumbers : kRow,
                      {{std::move(rate), 2.0}, {allan_chart(rules_[r], &allan_[r], last), 1.0}}});
    }
  }

 private:
  [[nodiscard]] Chart raw_chart() const {
    Chart chart(prefix_ + "raw, in a range of its own", "Raw rate over time.", time_.axis(false),
                {"°/h", false, {}, {}});
    chart.line_in_time(Role::kRaw, "", raw_.x, raw_.y);
    return chart;
  }
  // The raw rate's curve under each: how far the noise falls, and where it comes back.
  [[nodiscard]] Chart allan_chart(const std::string& rule, const AllanCurve* curve, bool last) const {
    ChartAxis tau = tau_;
    tau.numbered = last;
    if (last) tau.label = "averaging time τ (s)";
    Chart chart(rule + ", Allan deviation", "Allan deviation of the output and of the raw rate.", tau,
                sigma_);
    chart.line(Role::kRaw, "", raw_allan_.tau_s, raw_allan_.sigma);
    if (curve != nullptr) chart.line(Role::kAfter, "", curve->tau_s, curve->sigma);
    return chart;
  }

  const std::vector<std::string>& rules_;
  std::string prefix_;
  report::TimeAxis time_;
  report::Thinned raw_;
  std::vector<report::Thinned> outputs_;
  AllanCurve raw_allan_;
  std::vector<AllanCurve> allan_;
  ChartAxis rate_{"°/h", false, {}, {}}, tau_{"", true, {}, {}}, sigma_{"°/h", true, {}, {}};
};

}  // namespace

void draw_comparison(const std::string& path, const CaptureView& capture, const Comparison& result,
                     const std::vector<std::string>& rules) {
  std::vector<report::PictureRow> rows;
  for (std::size_t a = 0; a < capture.axes.size(); ++a) AxisRows(capture, result, rules, a).add_to(rows);
  report::write_picture(path, report::picture_svg("The same record by each rule; grey: raw", rows, 1100.0));
}

}  // namespace ifog::tools
