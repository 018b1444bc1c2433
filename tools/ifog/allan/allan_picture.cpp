#include "tools/ifog/allan/allan_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>

#include "filters/units/field_units.h"
#include "tools/report/picture.h"

namespace ifog::tools {
namespace {

using report::Chart;

struct Curve {
  std::vector<double> tau_s, sigma, low, high;  // °/h, τ ascending
};

struct Extent {
  double first = std::numeric_limits<double>::infinity(), last = 0.0;  // s
  double low = std::numeric_limits<double>::infinity(), high = 0.0;    // °/h
};

std::string file_name(const AllanRecord& record) {
  return std::filesystem::path(record.capture).filename().string();
}

bool several_files(const std::vector<AllanRecord>& records) {
  return std::any_of(records.begin(), records.end(),
                     [&](const AllanRecord& r) { return r.capture != records.front().capture; });
}

std::string title_of(const AllanRecord& record, bool several) {
  const std::string label = record.label();
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
  for (const std::size_t i : order) {
    curve.tau_s.push_back(record.tau_s[i]);
    curve.sigma.push_back(std::sqrt(record.points[i].variance) / kDegreePerHour);
    curve.low.push_back(record.intervals[i].lower_radps / kDegreePerHour);
    curve.high.push_back(record.intervals[i].upper_radps / kDegreePerHour);
    extent.first = std::min(extent.first, curve.tau_s.back());
    extent.last = std::max(extent.last, curve.tau_s.back());
    extent.low = std::min(extent.low, curve.sigma.back());
    extent.high = std::max(extent.high, curve.sigma.back());
  }
  return curve;
}

// Of a curve at τ, between its points on the logarithmic picture; 0 outside.
double height_at(const Curve& curve, double tau) {
  const auto above = std::lower_bound(curve.tau_s.begin(), curve.tau_s.end(), tau);
  if (curve.tau_s.empty() || above == curve.tau_s.end()) return 0.0;
  const auto i = static_cast<std::size_t>(above - curve.tau_s.begin());
  if (i == 0) return *above == tau ? curve.sigma[0] : 0.0;
  const double part = std::log(tau / curve.tau_s[i - 1]) / std::log(curve.tau_s[i] / curve.tau_s[i - 1]);
  return curve.sigma[i - 1] * std::pow(curve.sigma[i] / curve.sigma[i - 1], part);
}

// Draws the fitted terms as the straight lines that they are, each with its letter and value where it is
// farthest from every curve and every other word.
class TermLines {
 public:
  TermLines(Chart& chart, const std::vector<Curve>& curves, const Extent& extent)
      : chart_(chart), curves_(curves), extent_(extent), bottom_(extent.low / 4.0), top_(extent.high * 2.5) {}

  void add(report::Role role, const NoiseFit& fit, const NamedCoefficient& named) {
    NoiseFit alone;
    alone.*named.member = fit.*named.member;
    constexpr int kSteps = 200;
    std::vector<double> tau_s, sigma;
    double best = -1.0;
    std::array<char, 64> words{};
    std::snprintf(words.data(), words.size(), "%s = %.3g %s", named.letter,
                  (fit.*named.member).value * named.factor, named.unit);
    Chart::Word word{words.data(), 0.0, 0.0, anchor_of(named.letter[0])};
    for (int i = 0; i <= kSteps; ++i) {
      const double place = static_cast<double>(i) / kSteps;
      const double tau = extent_.first * std::pow(extent_.last / extent_.first, place);
      const double height = modelled_deviation(alone, tau) / kDegreePerHour;
      const double share = modelled_deviation(alone, tau) / modelled_deviation(fit, tau);
      if (height < bottom_ || height > top_ || share < 0.1) continue;
      tau_s.push_back(tau);
      sigma.push_back(height);
      if (place < 0.2 || place > 0.85 || height < bottom_ * 1.6 || height > top_ / 1.6) continue;
      const double clear = clearance(tau, height, place);
      if (clear <= best) continue;
      best = clear;
      word.x = tau;
      word.y = height / kBelow;
    }
    if (tau_s.size() < 2 || best < 0.0) return;
    words_.emplace_back(word.x, word.y * kBelow);
    chart_.guide(role, std::move(tau_s), std::move(sigma), std::move(word));
  }

 private:
  static constexpr double kBelow = 1.25;  // the word's distance from its line, as a factor

  // Below a falling line on its left, below a rising one on its right: clear of the line itself.
  static const char* anchor_of(char letter) {
    return letter == 'Q' || letter == 'N' ? "end" : letter == 'B' ? "middle" : "start";
  }
  [[nodiscard]] double clearance(double tau, double height, double place) const {
    double clear = 0.4 - 0.1 * std::abs(place - 0.5);
    for (const Curve& curve : curves_)
      if (const double y = height_at(curve, tau); y > 0.0)
        clear = std::min(clear, std::abs(std::log10(height / kBelow / y)));
    for (const auto& [x, y] : words_)
      clear = std::min(clear, std::hypot(std::log10(tau / x) / 4.0, std::log10(height / y)));
    return clear;
  }

  Chart& chart_;
  const std::vector<Curve>& curves_;
  const Extent& extent_;
  double bottom_, top_;
  std::vector<std::pair<double, double>> words_;
};

}  // namespace

Chart allan_chart(const std::string& title, const std::vector<AllanRecord>& records) {
  Extent extent;
  std::vector<Curve> curves;
  curves.reserve(records.size());
  for (const AllanRecord& record : records) curves.push_back(curve_of(record, extent));
  report::ChartAxis sigma{"Allan deviation (°/h)", true, {}, {}};
  if (extent.low <= extent.high) {
    sigma.low = extent.low / 3.0;
    sigma.high = extent.high * 2.0;
  }
  Chart chart(title, "Allan deviation over averaging time, both on logarithmic axes.",
              {"averaging time τ (s)", true, {}, {}}, sigma);
  const bool several = several_files(records);
  for (std::size_t r = 0; r < records.size(); ++r)
    chart.band(report::role_of(r), curves[r].tau_s, curves[r].low, curves[r].high);
  TermLines terms(chart, curves, extent);
  // For as many records as the eye can take.
  for (std::size_t r = 0; r < std::min<std::size_t>(records.size(), 3); ++r) {
    // A filter's output is not made of the standard's terms, and a curve that covers another needs no second
    // set of words.
    const bool covered = r > 0 && curves[r].sigma == curves[r - 1].sigma;
    if (!records[r].fit || records[r].signal == "denoised" || covered) continue;
    for (const NamedCoefficient& named : named_coefficients())
      if (((*records[r].fit).*named.member).present) terms.add(report::role_of(r), *records[r].fit, named);
  }
  for (std::size_t r = 0; r < records.size(); ++r) {
    const std::string name = title_of(records[r], several);
    const std::string label = records.size() == 1 ? "" : name;
    if (curves[r].tau_s.size() > 12)
      chart.line(report::role_of(r), label, curves[r].tau_s, curves[r].sigma);
    else
      chart.points(report::role_of(r), label, curves[r].tau_s, curves[r].sigma);
  }
  return chart;
}

void draw_allan(const std::string& path, const std::vector<AllanRecord>& records) {
  const std::string title =
      several_files(records) ? "Allan deviation" : "Allan deviation of " + file_name(records.front());
  report::write_picture(path, report::picture_svg("", {{560.0, {{allan_chart(title, records)}}}}, 900.0));
}

}  // namespace ifog::tools
