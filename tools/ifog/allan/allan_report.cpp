// An Allan analysis as JSON for programs (SI) and as a table (the field's units).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "filters/units/field_units.h"
#include "tools/ifog/allan/allan_record.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

using nlohmann::ordered_json;

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
  say("%s%s%s: %zu samples at %.9g Hz, %.6g s, mean %.5g °/h\n", record.capture.c_str(),
      record.label().empty() ? "" : " ", record.label().c_str(), record.samples, record.sample_rate_hz,
      static_cast<double>(record.samples) / record.sample_rate_hz, record.mean_radps / kDegreePerHour);
  for (const std::string& note : record.notes) say("  note: %s\n", note.c_str());
  say("  %12s  %12s  %25s  %9s  %s\n", "tau s", "sigma deg/h",
      text("%.3g %% interval", 100.0 * options.confidence).c_str(), "degrees", "noise here");
  // On a screen three points a decade say enough; what was asked for is always shown.
  double next = 0.0;
  for (std::size_t i = 0; i < record.points.size(); ++i) {
    const bool last = i + 1 == record.points.size();
    if (options.tau_s.empty() && record.tau_s[i] < next && !last) continue;
    next = record.tau_s[i] * 2.1;
    const AllanInterval& interval = record.intervals[i];
    say("  %12.6g  %12.5g  %12.5g … %-10.5g  %9.4g  %s%s\n", record.tau_s[i],
        std::sqrt(record.points[i].variance) / kDegreePerHour, interval.lower_radps / kDegreePerHour,
        interval.upper_radps / kDegreePerHour, interval.degrees, name_of(interval.type),
        record.tau_s[i] > record.trusted_tau_s * 1.0001 ? "  (too few averages to trust)" : "");
  }
  say("  To be trusted to a quarter up to %.4g s; a longer record shows more.\n", record.trusted_tau_s);
  if (!record.fit) return;
  for (const NamedCoefficient& named : named_coefficients()) {
    const NoiseCoefficient& c = (*record.fit).*named.member;
    if (c.present)
      say("  %s  %s %s %s  (%.4g ± %.2g %s)\n", named.letter, padded(named.meaning, 18).c_str(),
          padded(with_error(c.value * named.factor, c.std_error * named.factor), 24).c_str(),
          padded(named.unit, 7).c_str(), c.value, c.std_error, named.si_unit);
    else
      say("  %s  %s not seen; below about %.2g %s\n", named.letter, padded(named.meaning, 18).c_str(),
          2.0 * c.std_error * named.factor, named.unit);
  }
}

}  // namespace ifog::tools
