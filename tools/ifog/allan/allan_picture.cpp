// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/allan/allan_picture.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string_view>
#include <utility>

#include "filters/units/field_units.h"
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

  // Along the averaging times, 0 to 1.
  [[nodiscard]] double tau_at(double place) const { return first * std::pow(last / first, place); }
  [[nodiscard]] double place_of(double tau) const { return std::log(tau / first) / std::log(last / first); }
  // Lower edge of the picture, which leaves some room above and below.
  [[nodiscard]] double bottom() const { return low / 3.0; }
  [[nodiscard]] double top() const { return high * 2.0; }
  [[nodiscard]] bool shows(double sigma) const { return sigma > bottom() && sigma < top(); }
  [[nodiscard]] double decades() const { return std::log10(top() / bottom()); }
};

std::string file_name(const AllanRecord& record) {
  return std::filesystem::path(record.capture).filename().string();
}

bool several_files(const std::vector<AllanRecord>& records) {
  return std::any_of(records.begin(), records.end(),
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
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return record.tau_s[a] < record.tau_s[b]; });
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

// Value of a curve at τ, interpolated in logarithms; 0 outside.
double height_at(const Curve& curve, double tau) {
  const auto above = std::lower_bound(curve.tau_s.begin(), curve.tau_s.end(), tau);
  if (curve.tau_s.empty() || above == curve.tau_s.end()) return 0.0;
  const auto i = static_cast<std::size_t>(above - curve.tau_s.begin());
  if (i == 0) return *above == tau ? curve.sigma[0] : 0.0;
  const double part = std::log(tau / curve.tau_s[i - 1]) / std::log(curve.tau_s[i] / curve.tau_s[i - 1]);
  return curve.sigma[i - 1] * std::pow(curve.sigma[i] / curve.sigma[i - 1], part);
}

std::string in_words(const NoiseCoefficients& fit, const NamedCoefficient& named) {
  const double value = (fit.*named.member).value * named.factor;
  return std::string(named.letter) + " = " + report::number(value) + " " + named.unit;
}

// The fitted terms as the straight lines that they are. Of one record each has its letter and value where the
// word is farthest from every line and every other word; of several there is no such room, and their values
// stand next to the curves' names.
class TermLines {
 public:
  TermLines(const std::vector<Curve>& curves, const Extent& extent)
      : extent_(extent), obstacles_(curves), worded_(curves.size() == 1) {}

  void add(report::Role role, const NoiseCoefficients& fit, const NamedCoefficient& named) {
    NoiseCoefficients alone;
    alone.*named.member = fit.*named.member;
    Curve line;
    constexpr int kSteps = 200;
    for (int i = 0; i <= kSteps; ++i) {
      const double tau = extent_.tau_at(static_cast<double>(i) / kSteps);
      const double term = modelled_deviation(alone, tau);
      if (term < 0.1 * modelled_deviation(fit, tau) || !extent_.shows(term / kDegreePerHour)) continue;
      line.tau_s.push_back(tau);
      line.sigma.push_back(term / kDegreePerHour);
    }
    if (line.tau_s.size() < 2) return;
    terms_.push_back({role, obstacles_.size(), worded_ ? in_words(fit, named) : ""});
    obstacles_.push_back(std::move(line));
  }

  void draw(Chart& chart) {
    for (const Term& term : terms_) {
      const Curve line = obstacles_[term.line];  // a copy: the words placed are added to the obstacles
      chart.guide(term.role, line.tau_s, line.sigma, worded_ ? place(term.words, line) : Chart::Word{});
    }
  }

 private:
  struct Term {
    report::Role role;
    std::size_t line;  // among the obstacles
    std::string words;
  };

  // The word stands next to its line: below it or above, its beginning, middle or end there.
  Chart::Word place(const std::string& words, const Curve& line) {
    Chart::Word best{words, line.tau_s.front(), line.sigma.front(), "start"};
    double most = -1.0;
    for (std::size_t i = 0; i < line.tau_s.size(); i += 4)
      for (const auto& [anchor, begins] : {std::pair{"start", 0.0}, {"end", -1.0}})
        for (const double beside : {1.0 / 1.25, 1.15}) {
          const double height = line.sigma[i] * beside;
          const double clear =
              clearance(extent_.place_of(line.tau_s[i]) + begins * width_of(words), height, width_of(words));
          if (clear <= most) continue;
          most = clear;
          best = {words, line.tau_s[i], height, anchor};
        }
    const double begins = std::string_view(best.anchor) == "end" ? -1.0 : 0.0;
    const double at = extent_.place_of(best.x) + begins * width_of(words);
    // Where a word is, no other goes: it becomes one more line.
    obstacles_.push_back(
        {{extent_.tau_at(at), extent_.tau_at(at + width_of(words))}, {best.y, best.y}, {}, {}});
    return best;
  }
  // Shares of the picture's width and height, roughly: 7 pixels a letter of 800, half a line of 460.
  static double width_of(const std::string& words) { return 0.0085 * static_cast<double>(words.size()); }
  [[nodiscard]] double clearance(double from, double height, double width) const {
    if (from < 0.02 || from + width > 0.97 || !extent_.shows(height * 1.2) || !extent_.shows(height / 1.2))
      return -1.0;
    constexpr int kProbes = 8;
    double clear = 0.1;  // farther away is no better
    for (int i = 0; i <= kProbes; ++i)
      for (const Curve& curve : obstacles_)
        if (const double y = height_at(curve, extent_.tau_at(from + width * i / kProbes)); y > 0.0)
          clear = std::min(clear, std::abs(std::log10(height * 1.05 / y)) / extent_.decades());
    return clear;
  }

  const Extent& extent_;
  std::vector<Curve> obstacles_;
  bool worded_;
  std::vector<Term> terms_;
};

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
  TermLines terms(curves, extent);
  std::vector<std::string> labels;
  for (std::size_t r = 0; r < records.size(); ++r) {
    labels.push_back(records.size() == 1 ? "" : title_of(records[r], several));
    // A filter's output is not made of the standard's terms, and a curve that covers another needs no second
    // set of words.
    const bool covered = r > 0 && curves[r].sigma == curves[r - 1].sigma;
    if (!records[r].fit || records[r].signal == "denoised" || covered) continue;
    const char* before = ": ";
    for (const NamedCoefficient& named : named_coefficients()) {
      if (!((*records[r].fit).*named.member).present) continue;
      // Lines for as many records as the eye can take.
      if (r < kMostWithLines) terms.add(report::role_of(r), *records[r].fit, named);
      if (records.size() == 1) continue;
      labels[r] += std::exchange(before, ", ") + in_words(*records[r].fit, named);
    }
  }
  terms.draw(chart);
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
