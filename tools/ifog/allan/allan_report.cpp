// The three ways to tell an Allan analysis: JSON for programs (SI), a table (the field's units) and a
// picture.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <numbers>

#include "tools/ifog/allan/allan_record.h"
#include "tools/ifog/plot.h"

namespace ifog::tools {
namespace {

using nlohmann::ordered_json;

constexpr double kDegreesPerHour = 180.0 / std::numbers::pi * 3600.0;

const char* name_of(NoiseType type) {
  switch (type) {
    case NoiseType::kQuantisation:
      return "white phase";
    case NoiseType::kFlickerPhase:
      return "flicker phase";
    case NoiseType::kAngleRandomWalk:
      return "white rate";
    case NoiseType::kBiasInstability:
      return "flicker rate";
    case NoiseType::kRateRandomWalk:
      return "random walk";
  }
  return "";
}

const char* name_of(Deviation kind) {
  return kind == Deviation::kModified   ? "modified"
         : kind == Deviation::kHadamard ? "hadamard"
                                        : "overlapping";
}

// JSON has no NaN.
ordered_json finite(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

std::string text(const char* format, double a, double b = 0.0) {
  std::array<char, 96> line{};
  std::snprintf(line.data(), line.size(), format, a, b);
  return line.data();
}

// Pads by characters, not bytes: ° and √ take two or three.
std::string padded(std::string s, std::size_t width) {
  std::size_t characters = 0;
  for (const char c : s) characters += (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  if (characters < width) s.append(width - characters, ' ');
  return s;
}

std::string with_error(double value, double error) {
  // As many digits as the error has to say: two of its own.
  const int digits =
      error > 0.0 && value > 0.0
          ? std::clamp(static_cast<int>(std::floor(std::log10(value)) - std::floor(std::log10(error))) + 2, 2,
                       8)
          : 3;
  std::array<char, 96> line{};
  std::snprintf(line.data(), line.size(), "%.*g ± %.2g", digits, value, error);
  return line.data();
}

// Of a curve at x, between its points on the logarithmic picture; 0 outside.
double height_at(const Curve& curve, double x) {
  const auto above = std::lower_bound(curve.x.begin(), curve.x.end(), x);
  if (curve.x.empty() || above == curve.x.end()) return 0.0;
  const auto i = static_cast<std::size_t>(above - curve.x.begin());
  if (i == 0) return *above == x ? curve.y[0] : 0.0;
  const double part = std::log(x / curve.x[i - 1]) / std::log(curve.x[i] / curve.x[i - 1]);
  return curve.y[i - 1] * std::pow(curve.y[i] / curve.y[i - 1], part);
}

std::string title_of(const AllanRecord& record, bool several_files) {
  std::string title = record.label();
  if (several_files || title.empty()) {
    std::string file = std::filesystem::path(record.capture).filename().string();
    title = title.empty() ? file : file + " " + title;
  }
  return title;
}

}  // namespace

ordered_json allan_json(const std::vector<AllanRecord>& records, const AllanOptions& options) {
  ordered_json out;
  out["schema"] = "ifog.allan/1";
  out["sample_rate_hz"] = records.front().sample_rate_hz;
  out["estimator"] = name_of(options.kind);
  out["confidence"] = options.confidence;
  out["axes"] = ordered_json::array();
  for (const AllanRecord& record : records) {
    ordered_json axis;
    axis["axis"] = record.axis;
    axis["capture"] = record.capture;
    axis["signal"] = record.signal;
    axis["sample_rate_hz"] = record.sample_rate_hz;
    axis["samples"] = record.samples;
    axis["missing"] = record.missing;
    axis["gaps"] = record.gaps;
    axis["longest_stretch"] = record.longest;
    axis["mean_radps"] = record.mean_radps;
    axis["tau_s"] = record.tau_s;
    for (const char* key :
         {"adev_radps", "lower_radps", "upper_radps", "degrees_of_freedom", "noise_type", "terms"})
      axis[key] = ordered_json::array();
    for (std::size_t i = 0; i < record.points.size(); ++i) {
      const AllanInterval& interval = record.intervals[i];
      axis["adev_radps"].push_back(finite(std::sqrt(record.points[i].variance)));
      axis["lower_radps"].push_back(finite(interval.lower_radps));
      axis["upper_radps"].push_back(finite(interval.upper_radps));
      axis["degrees_of_freedom"].push_back(interval.degrees);
      axis["noise_type"].push_back(name_of(interval.type));
      axis["terms"].push_back(record.points[i].terms);
    }
    axis["trusted_tau_s"] = record.trusted_tau_s;
    axis["coefficients"] = ordered_json::object();
    for (const NamedCoefficient& named : named_coefficients()) {
      const NoiseCoefficient c = record.fit ? (*record.fit).*named.member : NoiseCoefficient{};
      axis["coefficients"][named.letter] = {
          {"value", c.value},
          {"std_error", record.fit ? finite(c.std_error) : ordered_json(nullptr)},
          {"unit", named.si_unit},
          {"present", c.present}};
    }
    axis["misfit"] = record.fit ? finite(record.fit->misfit) : ordered_json(nullptr);
    axis["notes"] = record.notes;
    out["axes"].push_back(axis);
  }
  return out;
}

void print_allan(const AllanRecord& record, const AllanOptions& options) {
  std::printf("%s%s%s: %zu samples at %.9g Hz, %.6g s, mean %.5g °/h\n", record.capture.c_str(),
              record.label().empty() ? "" : " ", record.label().c_str(), record.samples,
              record.sample_rate_hz, static_cast<double>(record.samples) / record.sample_rate_hz,
              record.mean_radps * kDegreesPerHour);
  for (const std::string& note : record.notes) std::printf("  note: %s\n", note.c_str());
  std::printf("  %12s  %12s  %25s  %9s  %s\n", "tau s", "sigma deg/h",
              text("%.3g %% interval", 100.0 * options.confidence).c_str(), "degrees", "noise here");
  // On a screen three points a decade say enough; what was asked for is always shown.
  double next = 0.0;
  for (std::size_t i = 0; i < record.points.size(); ++i) {
    const bool last = i + 1 == record.points.size();
    if (options.tau_s.empty() && record.tau_s[i] < next && !last) continue;
    next = record.tau_s[i] * 2.1;
    const AllanInterval& interval = record.intervals[i];
    std::printf("  %12.6g  %12.5g  %12.5g … %-10.5g  %9.4g  %s%s\n", record.tau_s[i],
                std::sqrt(record.points[i].variance) * kDegreesPerHour,
                interval.lower_radps * kDegreesPerHour, interval.upper_radps * kDegreesPerHour,
                interval.degrees, name_of(interval.type),
                record.tau_s[i] > record.trusted_tau_s * 1.0001 ? "  (too few averages to trust)" : "");
  }
  std::printf("  To be trusted to a quarter up to %.4g s; a longer record shows more.\n",
              record.trusted_tau_s);
  if (!record.fit) return;
  for (const NamedCoefficient& named : named_coefficients()) {
    const NoiseCoefficient& c = (*record.fit).*named.member;
    if (c.present)
      std::printf("  %s  %s %s %s  (%.4g ± %.2g %s)\n", named.letter, padded(named.meaning, 18).c_str(),
                  padded(with_error(c.value * named.factor, c.std_error * named.factor), 24).c_str(),
                  padded(named.unit, 7).c_str(), c.value, c.std_error, named.si_unit);
    else
      std::printf("  %s  %s not seen; below about %.2g %s\n", named.letter, padded(named.meaning, 18).c_str(),
                  2.0 * c.std_error * named.factor, named.unit);
  }
}

Panel allan_panel(const std::vector<AllanRecord>& records) {
  static const std::array<const char*, 6> kColors{"#1f77b4", "#d62728", "#2ca02c",
                                                  "#9467bd", "#ff7f0e", "#17becf"};
  const bool several_files = std::any_of(records.begin(), records.end(), [&](const AllanRecord& r) {
    return r.capture != records.front().capture;
  });
  Panel panel;
  panel.title = several_files ? "Allan deviation"
                              : "Allan deviation of " +
                                    std::filesystem::path(records.front().capture).filename().string();
  panel.x_label = "averaging time, s";
  panel.y_label = "°/h";
  panel.log_x = panel.log_y = true;
  double low = std::numeric_limits<double>::infinity(), high = 0.0, first = low, last = 0.0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const AllanRecord& record = records[r];
    Curve curve;
    curve.title = title_of(record, several_files);
    curve.color = kColors[r % kColors.size()];
    // Thinner from curve to curve, so that one that lies on another leaves it visible.
    curve.style = record.points.size() > 12 ? (r % 2 == 0 ? "lines lw 3" : "lines lw 1.5")
                                            : "linespoints lw 2 pt 7 ps 0.7";
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < record.points.size(); ++i)
      if (record.points[i].variance > 0.0) order.push_back(i);
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return record.tau_s[a] < record.tau_s[b]; });
    for (const std::size_t i : order) {
      curve.x.push_back(record.tau_s[i]);
      curve.y.push_back(std::sqrt(record.points[i].variance) * kDegreesPerHour);
      curve.low.push_back(record.intervals[i].lower_radps * kDegreesPerHour);
      curve.high.push_back(record.intervals[i].upper_radps * kDegreesPerHour);
      low = std::min(low, curve.y.back());
      high = std::max(high, curve.y.back());
      first = std::min(first, curve.x.back());
      last = std::max(last, curve.x.back());
    }
    panel.curves.push_back(std::move(curve));
  }
  if (!(low < high)) {
    low = std::isfinite(low) ? low * 0.5 : 0.1;
    high = high > 0.0 ? high * 2.0 : 1.0;
  }
  const double bottom = low / 4.0, top = high * 2.5;
  panel.extra.push_back(text("set yrange [%.6g:%.6g]", bottom, top));
  // The fitted terms as straight lines, for as many records as the eye can take.
  std::vector<std::pair<double, double>> labels;
  for (std::size_t r = 0; r < records.size() && r < 3; ++r) {
    const AllanRecord& record = records[r];
    // A filter's output is not made of the standard's terms, and a curve that covers another needs no second
    // set of labels.
    const bool covered = r > 0 && panel.curves[r].y == panel.curves[r - 1].y;
    if (!record.fit || record.signal == "denoised" || covered) continue;
    for (const NamedCoefficient& named : named_coefficients()) {
      const NoiseCoefficient& c = (*record.fit).*named.member;
      if (!c.present) continue;
      NoiseFit alone;
      alone.*named.member = c;
      Curve line;
      line.color = kColors[r % kColors.size()];
      line.style = "lines dt 2 lw 1";
      // The label stands where the line is farthest from every curve, away from the frame.
      constexpr int kSteps = 200;
      double best = -1.0, at = first, height = 0.0;
      for (int i = 0; i <= kSteps; ++i) {
        const double place = static_cast<double>(i) / kSteps;
        const double tau = first * std::pow(last / first, place);
        const double sigma = modelled_deviation(alone, tau) * kDegreesPerHour;
        const double share = modelled_deviation(alone, tau) / modelled_deviation(*record.fit, tau);
        if (sigma < bottom || sigma > top || share < 0.1) continue;
        line.x.push_back(tau);
        line.y.push_back(sigma);
        if (place < 0.2 || place > 0.85 || sigma < bottom * 1.6 || sigma > top / 1.6) continue;
        double clear = 0.4 - 0.1 * std::abs(place - 0.5);
        for (const Curve& curve : panel.curves)
          if (const double y = height_at(curve, tau); y > 0.0)
            clear = std::min(clear, std::abs(std::log10(sigma / 1.3 / y)));
        for (const auto& [x, y] : labels)
          clear = std::min(clear, std::hypot(std::log10(tau / x) / 4.0, std::log10(sigma / y)));
        if (clear <= best) continue;
        best = clear;
        at = tau;
        height = sigma;
      }
      if (line.x.size() < 2) continue;
      const std::string words =
          std::string(named.letter) + " = " + text("%.3g ", c.value * named.factor) + named.unit;
      labels.emplace_back(at, height);
      // Below a falling line on its left, below a rising one on its right: clear of the line itself.
      const char letter = named.letter[0];
      const char* side = letter == 'Q' || letter == 'N' ? " right" : letter == 'B' ? " center" : " left";
      panel.extra.push_back("set label " + std::to_string(labels.size()) + " \"" + words + "\" at " +
                            text("%.6g,%.6g", at, height / 1.35) + side + " textcolor rgb '" + line.color +
                            "' front noenhanced");
      panel.curves.push_back(std::move(line));
    }
  }
  return panel;
}

void plot_allan(const std::string& path, const std::vector<AllanRecord>& records) {
  plot(path, {allan_panel(records)}, 1000, 640);
}

}  // namespace ifog::tools
