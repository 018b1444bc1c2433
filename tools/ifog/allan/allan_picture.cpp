// SPDX-License-Identifier: Apache-2.0
// Allan deviations as a picture.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "filters/units/field_units.h"
#include "tools/ifog/allan/allan_record.h"
#include "tools/report/picture.h"
#include "tools/report/text.h"

namespace ifog::tools {
namespace {

using report::Chart;

constexpr std::size_t kMostWithLines = 3;

struct Curve {
  std::vector<double> tau_s, sigma, low, high;  // °/h, τ ascending
};

struct Extent {
  double first = std::numeric_limits<double>::infinity(), last = 0.0;  // s
  double low = std::numeric_limits<double>::infinity(), high = 0.0;    // °/h

  // Averaging time at a place along the axis, 0 to 1.
  [[nodiscard]] double tau_at(double place) const { return first * std::pow(last / first, place); }
  // Lower edge of the picture; leaves room below the curves.
  [[nodiscard]] double bottom() const { return low / 3.0; }
  [[nodiscard]] double top() const { return high * 2.0; }
  [[nodiscard]] bool shows(double sigma) const { return sigma > bottom() && sigma < top(); }
};

std::string file_name(const AllanRecord& record) {
  return std::filesystem::path(record.capture).filename().string();
}

bool several_files(const std::vector<AllanRecord>& records) {
  return std::ranges::any_of(records,
                             [&](const AllanRecord& r) { return r.capture != records.front().capture; });
}

std::string title_of(const AllanRecord& record, bool several) {
  std::string label = record.label();
  if (!several && !label.empty()) return label;
  return label.empty() ? file_name(record) : file_name(record) + " " + label;
}

Curve curve_of(const AllanRecord& record, Extent& extent) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < record.points.size(); ++i)
    if (record.points[i].variance > 0.0) order.push_back(i);
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return record.tau_s[a] < record.tau_s[b]; });
  Curve curve;
  const auto add = [&](double tau_s, double variance, const AllanInterval& interval) {
    curve.tau_s.push_back(tau_s);
    curve.sigma.push_back(std::sqrt(variance) / kDegreePerHour);
    curve.low.push_back(interval.lower_radps / kDegreePerHour);
    curve.high.push_back(interval.upper_radps / kDegreePerHour);
    extent.first = std::min(extent.first, curve.tau_s.back());
    extent.last = std::max(extent.last, curve.tau_s.back());
    extent.low = std::min(extent.low, curve.sigma.back());
    extent.high = std::max(extent.high, curve.sigma.back());
  };
  for (const std::size_t i : order) add(record.tau_s[i], record.points[i].variance, record.intervals[i]);
  for (const LongPoint& point : record.longer)
    if (curve.tau_s.empty() || point.tau > curve.tau_s.back()) add(point.tau, point.variance, point.interval);
  return curve;
}

std::string in_words(const NoiseCoefficients& fit, const NamedCoefficient& named) {
  const double value = (fit.*named.member).value * named.factor;
  return std::string(named.letter) + " = " + report::number(value) + " " + named.unit;
}

// Draws a fitted term as a straight line in the range where it contributes.
void draw_term(Chart& chart, report::Role role, const NoiseCoefficients& fit, const NamedCoefficient& named,
               const Extent& extent) {
  NoiseCoefficients alone;
  alone.*named.member = fit.*named.member;
  std::vector<double> tau_s, sigma;
  constexpr int kSteps = 200;
  for (int i = 0; i <= kSteps; ++i) {
    const double tau = extent.tau_at(static_cast<double>(i) / kSteps);
    const double term = modelled_deviation(alone, tau);
    if (term < 0.1 * modelled_deviation(fit, tau) || !extent.shows(term / kDegreePerHour)) continue;
    tau_s.push_back(tau);
    sigma.push_back(term / kDegreePerHour);
  }
  if (tau_s.size() > 1) chart.guide(role, std::move(tau_s), std::move(sigma));
}

}  // namespace

Chart allan_chart(const std::string& title, const std::vector<AllanRecord>& records) {
  Extent extent;
  std::vector<Curve> curves;
  curves.reserve(records.size());
  for (const AllanRecord& record : records) curves.push_back(curve_of(record, extent));
  report::ChartAxis sigma{"Allan deviation (°/h)", true, {}, {}};
  if (extent.low <= extent.high) {
    sigma.low = extent.bottom();
    sigma.high = extent.top();
  }
  Chart chart(title, "Allan deviation over averaging time, both on logarithmic axes.",
              {"averaging time τ (s)", true, {}, {}}, sigma);
  const bool several = several_files(records);
  for (std::size_t r = 0; r < records.size(); ++r)
    chart.band(report::role_of(r), curves[r].tau_s, curves[r].low, curves[r].high);
  std::vector<std::string> labels;
  for (std::size_t r = 0; r < records.size(); ++r) {
    labels.push_back(records.size() == 1 ? "" : title_of(records[r], several));
    // A filter's output does not consist of the standard's terms, and of two equal curves one is labelled.
    const bool covered = r > 0 && curves[r].sigma == curves[r - 1].sigma;
    if (!records[r].fit || records[r].signal == "denoised" || covered) continue;
    const char* before = labels[r].empty() ? "" : ": ";
    for (const NamedCoefficient& named : named_coefficients()) {
      if (!((*records[r].fit).*named.member).present) continue;
      // More lines would not be readable.
      if (r < kMostWithLines) draw_term(chart, report::role_of(r), *records[r].fit, named, extent);
      labels[r] += std::exchange(before, ", ") + in_words(*records[r].fit, named);
    }
  }
  for (std::size_t r = 0; r < records.size(); ++r) {
    if (curves[r].tau_s.size() > 12)
      chart.line(report::role_of(r), labels[r], curves[r].tau_s, curves[r].sigma);
    else
      chart.points(report::role_of(r), labels[r], curves[r].tau_s, curves[r].sigma);
  }
  return chart;
}

void draw_allan(const std::string& path, const std::vector<AllanRecord>& records) {
  const std::string title =
      several_files(records) ? "Allan deviation" : "Allan deviation of " + file_name(records.front());
  report::write_picture(path, report::picture_svg("", {{560.0, {{allan_chart(title, records)}}}}, 900.0));
}

}  // namespace ifog::tools
