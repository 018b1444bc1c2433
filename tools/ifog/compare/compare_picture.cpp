#include "tools/ifog/compare/compare_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <span>

#include "filters/allan/deviation.h"
#include "filters/allan/stretches.h"
#include "filters/settings/filter_settings.h"
#include "tools/ifog/plot.h"

namespace ifog::tools {
namespace {

constexpr double kDegPerHour = 180.0 / std::numbers::pi * 3600.0;  // of 1 rad/s
constexpr const char* kRawColor = "#b8b8b8";
// Apart for most colour-blind eyes too (Okabe and Ito), the last two from the same scale, darker.
constexpr std::array kColors{"#e69f00", "#0072b2", "#009e73", "#cc79a7", "#d55e00", "#56b4e9", "#000000"};

const char* color(std::size_t rule) { return kColors[rule % kColors.size()]; }

// The smallest and the largest value of each of a few hundred stretches: a picture has no more pixels, and
// taking every nth sample would fold a line of the record down to a slow wave that is not there.
Curve thinned(const std::string& title, const std::vector<double>& time, std::span<const double> rate) {
  Curve curve;
  curve.title = title;
  constexpr std::size_t kStretches = 1500;
  const std::size_t length = std::max<std::size_t>(1, rate.size() / kStretches);
  for (std::size_t begin = 0; begin < rate.size(); begin += length) {
    const auto part = rate.subspan(begin, std::min(length, rate.size() - begin));
    const auto [low, high] = std::minmax_element(part.begin(), part.end());
    for (const auto at : low < high ? std::array{low, high} : std::array{high, low}) {
      curve.x.push_back(time[begin + static_cast<std::size_t>(at - part.begin())]);
      curve.y.push_back(*at * kDegPerHour);
    }
  }
  return curve;
}

std::string range(const char* axis, double low, double high) {
  char text[96];
  std::snprintf(text, sizeof text, "set %srange [%.12g:%.12g]", axis, low, high);
  return text;
}

// What the curves keep to once their filters have started: the first twentieth and the outermost two in a
// thousand values left out, with a margin.
std::string kept_range(const std::vector<Curve>& curves) {
  std::vector<double> values;
  for (const Curve& curve : curves) {
    const auto begin = curve.y.begin() + static_cast<std::ptrdiff_t>(curve.y.size() / 20);
    std::copy_if(begin, curve.y.end(), std::back_inserter(values), [](double y) { return std::isfinite(y); });
  }
  if (values.empty()) return "set autoscale y";
  std::sort(values.begin(), values.end());
  const std::size_t cut = values.size() / 1000;
  const double low = values[cut], high = values[values.size() - 1 - cut];
  const double margin = std::max(0.1 * (high - low), 1e-9);
  return range("y", low - margin, high + margin);
}

Curve allan(const std::string& title, const Capture& capture, std::span<const double> rate,
            const SampleClock& clock) {
  Curve curve;
  curve.title = title;
  const std::vector<Stretch> whole = stretches(capture.time_s, rate, clock);
  if (whole.empty()) return curve;
  const AngleSum sum(rate, whole);
  for (const DeviationPoint& point : deviation(sum, log_spaced(sum.longest() / 4, 6))) {
    if (point.terms == 0 || !(point.variance > 0.0)) continue;
    curve.x.push_back(static_cast<double>(point.m) * clock.period_s);
    curve.y.push_back(std::sqrt(point.variance) * kDegPerHour);
  }
  return curve;
}

}  // namespace

void draw_comparison(const std::string& path, const Capture& capture, const Comparison& result,
                     const std::vector<std::string>& rules) {
  // The same margins for every panel, so that their times stand below each other.
  const std::string outside = "set key outside right top; set lmargin 12; set rmargin 20";
  const std::string times = range("x", capture.time_s.front(), capture.time_s.back());
  const auto found = std::find(rules.begin(), rules.end(), FilterSettings{}.rule);
  const auto shown = static_cast<std::size_t>(found == rules.end() ? 0 : found - rules.begin());
  // The daemon's default last: where rules agree the last curve hides the others.
  std::vector<std::size_t> order;
  for (std::size_t r = 0; r < rules.size(); ++r)
    if (r != shown) order.push_back(r);
  order.push_back(shown);
  std::vector<Panel> panels;
  for (std::size_t a = 0; a < capture.axes.size(); ++a) {
    const std::string axis = capture.axes[a].empty() ? "" : "Axis " + capture.axes[a] + ": ";
    Panel record{axis + "raw rate, and denoised by " + rules[shown],
                 "time, s",
                 "rate, °/h",
                 false,
                 false,
                 {},
                 {outside, times}};
    record.curves.push_back(thinned("raw", capture.time_s, capture.rate_radps[a]));
    record.curves.back().color = kRawColor;
    record.curves.push_back(thinned(rules[shown], capture.time_s, result.denoised[shown][a]));
    record.curves.back().color = color(shown);
    panels.push_back(std::move(record));

    Panel all{axis + "denoised by each rule, " + rules[shown] + " on top, in the range they keep to",
              "time, s",
              "rate, °/h",
              false,
              false,
              {},
              {outside, times}};
    for (const std::size_t r : order) {
      all.curves.push_back(thinned(rules[r], capture.time_s, result.denoised[r][a]));
      all.curves.back().color = color(r);
    }
    all.extra.push_back(kept_range(all.curves));
    panels.push_back(std::move(all));
  }
  Panel noise{"Allan deviation of each output",
              "averaging time, s",
              "Allan deviation, °/h",
              true,
              true,
              {},
              {outside}};
  if (capture.axes.size() > 1) noise.title += ", axis " + capture.axes[0];
  const SampleClock clock = sample_clock(capture.time_s);
  noise.curves.push_back(allan("raw", capture, capture.rate_radps[0], clock));
  noise.curves.back().color = kRawColor;
  for (const std::size_t r : order) {
    noise.curves.push_back(allan(rules[r], capture, result.denoised[r][0], clock));
    noise.curves.back().color = color(r);
  }
  std::erase_if(noise.curves, [](const Curve& curve) { return curve.x.empty(); });
  if (!noise.curves.empty()) {
    noise.extra.push_back(range("x", noise.curves[0].x.front(), noise.curves[0].x.back()));
    panels.push_back(std::move(noise));
  }
  plot(path, panels, 1200, panels.size() > 3 ? 300 : 400);
}

}  // namespace ifog::tools
