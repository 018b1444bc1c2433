// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/compare/verdict.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "filters/allan/deviation.h"
#include "filters/allan/stretches.h"
#include "filters/units/field_units.h"
#include "tools/report/picture.h"
#include "tools/report/scale.h"

namespace ifog::tools {
namespace {

struct VerdictFigure {
  const char *key, *words;
  std::optional<double> (*of)(const ComparisonRow&);
};
// The first figure that every row has is used.
constexpr std::array kVerdictFigures{
    VerdictFigure{"rmse_radps", "error against the reference",
                  [](const ComparisonRow& row) { return row.rmse_radps; }},
    VerdictFigure{"adev_radps 1", "Allan deviation at 1 s",
                  [](const ComparisonRow& row) { return row.adev_radps[1]; }},
    VerdictFigure{"adev_radps 0.1", "Allan deviation at 0.1 s",
                  [](const ComparisonRow& row) { return row.adev_radps[0]; }},
    VerdictFigure{"std_radps", "standard deviation",
                  [](const ComparisonRow& row) { return std::optional(row.std_radps); }}};

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

Verdict verdict_of(const Comparison& result, int axis) {
  constexpr double kAlike = 0.01;
  std::vector<const ComparisonRow*> rows;  // raw first
  for (const ComparisonRow& row : result.rows)
    if (row.axis == axis) rows.push_back(&row);
  const VerdictFigure& figure =
      *std::find_if(kVerdictFigures.begin(), kVerdictFigures.end() - 1, [&](const VerdictFigure& each) {
        return std::ranges::all_of(rows, [&](const ComparisonRow* row) { return each.of(*row).has_value(); });
      });
  Verdict out{figure.key, 0, *figure.of(*rows.at(1)), *figure.of(*rows[0]), {}, {}};
  for (std::size_t r = 1; r < rows.size(); ++r)
    if (const double value = *figure.of(*rows[r]); value < out.best_radps) {
      out.best = r - 1;
      out.best_radps = value;
    }
  std::string alike;
  double most = 0.0;
  std::size_t others = 0;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    const double above = out.best_radps > 0.0 ? *figure.of(*rows[r]) / out.best_radps - 1.0 : 0.0;
    out.above.push_back(above);
    most = std::max(most, above);
    if (above > kAlike) ++others;
    if (above <= kAlike && r - 1 != out.best) alike += (alike.empty() ? "" : ", ") + rows[r]->rule;
  }
  out.text = fmt::format("{}: {} {:.4g} °/h, raw {:.4g}", rows[out.best + 1]->rule, figure.words,
                         out.best_radps / kDegreePerHour, out.raw_radps / kDegreePerHour);
  out.text =
      (out.best_radps < out.raw_radps ? "best is " : "none is better than raw, the best rule is ") + out.text;
  if (others == 0)
    out.text += fmt::format("; all rules within {:.2g} % of it", 100.0 * most);
  else
    out.text += (alike.empty() ? "" : "; within 1 % of it " + alike) +
                fmt::format("; others up to {:.3g} % above", 100.0 * most);
  return out;
}

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
