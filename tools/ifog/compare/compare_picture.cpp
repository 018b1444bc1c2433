// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/compare/compare_picture.h"

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

// Ratio of two curves at the averaging times of both.
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

// A curve in the units of the picture, thinned to the points that are drawn.
report::Thinned drawn(const CaptureView& capture, const report::TimeAxis& axis,
                      std::span<const double> rate_radps) {
  Samples time(capture.time_s), rate(rate_radps);
  for (double& t : time) t = axis(capture.origin.in_s(t));
  for (double& r : rate) r *= 1.0 / kDegreePerHour;
  return report::thinned(time, rate);
}

void add_axis(const CaptureView& capture, const std::vector<std::vector<Samples>>& denoised,
              const std::vector<std::string>& rules, std::size_t axis, std::size_t best,
              std::vector<report::PictureRow>& rows) {
  const std::string of = capture.axes[axis].empty() ? "" : "axis " + capture.axes[axis] + ": ";
  const report::TimeAxis time(capture.shown_time_s(0), capture.shown_time_s(capture.size() - 1));
  const SampleClock clock = sample_clock(capture.time_s);
  const report::ChartAxis tau{"averaging time τ (s)", true, {}, {}};
  Chart rate(of + "rate", "Raw rate and that of the best rule over time.", time.axis(),
             {"rate (°/h)", false, {}, {}});
  Chart deviations(of + "Allan deviation", "Allan deviation over averaging time.", tau,
                   {"Allan deviation (°/h)", true, {}, {}});
  const auto add = [&](Role role, const std::string& name, std::span<const double> rate_radps) {
    report::Thinned curve = drawn(capture, time, rate_radps);
    rate.line_in_time(role, name, std::move(curve.x), std::move(curve.y));
    AllanCurve deviation = allan(capture, rate_radps, clock);
    deviations.line(role, name, deviation.tau_s, deviation.sigma);
    return deviation;
  };
  add(Role::kRaw, "raw", capture.rate_radps[axis]);
  const AllanCurve of_best = add(Role::kAfter, rules[best], denoised[best][axis]);

  Chart others(of + "Allan deviation over that of " + rules[best], "Its ratio over averaging time.", tau,
               {"ratio", false, {}, {}});
  for (std::size_t r = 0, shown = 0; r < rules.size(); ++r) {
    if (r == best) continue;
    AllanCurve ratio = over(allan(capture, denoised[r][axis], clock), of_best);
    others.line(report::role_of(shown++), rules[r], std::move(ratio.tau_s), std::move(ratio.sigma));
  }
  constexpr double kRow = 300.0;  // px
  rows.push_back({kRow, {{std::move(rate), 2.0}, {std::move(deviations), 1.0}}});
  rows.push_back({kRow, {{std::move(others)}}});
}

}  // namespace

void draw_comparison(const std::string& path, const CaptureView& capture, const Comparison& result,
                     const std::vector<std::string>& rules, const std::vector<Verdict>& verdicts) {
  std::vector<report::PictureRow> rows;
  std::string title;
  for (std::size_t a = 0; a < capture.axes.size(); ++a) {
    add_axis(capture, result.denoised, rules, a, verdicts[a].best, rows);
    title += (title.empty() ? "" : "; ") + (capture.axes[a].empty() ? "" : capture.axes[a] + ": ") +
             (capture.axes.size() == 1 ? verdicts[a].text
                                       : verdicts[a].text.substr(0, verdicts[a].text.find(':')));
  }
  report::write_picture(path, report::picture_svg(title, rows, 1100.0));
}

}  // namespace ifog::tools
