// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/undeclared/contradictions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "filters/effects/compensate_series.h"
#include "tests/bench/undeclared/scoring.h"

namespace ifog::undeclared {
namespace {

using Series = std::vector<double>;

double rms_of_means(const Capture& capture, const Series& error) {
  const double dt = capture.time_s[1] - capture.time_s[0];
  Series means = block_means(error, dt, 10.0);
  std::erase_if(means, [](double value) { return !std::isfinite(value); });
  double mean = 0.0, square = 0.0;
  for (const double value : means) mean += value / static_cast<double>(means.size());
  for (const double value : means) square += (value - mean) * (value - mean);
  return std::sqrt(square / static_cast<double>(means.size()));
}

// Rate minus the model's effects and the reference if there is one; an empty model leaves the capture
// uncorrected.
Series left_by(const Model& model, const Capture& capture) {
  Compensator compensator(model, {""}, std::numeric_limits<double>::infinity(), 0.0);
  SeriesToCompensate series{capture.time_s, {capture.rate_radps[0]}, {}};
  for (const std::string& name : compensator.channels())
    for (const CaptureColumn& column : capture.channels)
      if (column.name == name) series.channels.emplace_back(column.values);
  Series error(capture.size());
  compensate_series(compensator, series, [&](std::size_t k, const CompensatorOutput& out) {
    error[k] = out.compensated_radps[0];
    if (!capture.reference_rate_radps[0].empty()) error[k] -= capture.reference_rate_radps[0][k];
  });
  return error;
}

bool said(const Diagnosis& diagnosis, const std::string& words) {
  return std::any_of(diagnosis.remarks.begin(), diagnosis.remarks.end(),
                     [&](const std::string& remark) { return remark.find(words) != std::string::npos; });
}

void growing(const Diagnosis& diagnosis, double samples, std::vector<std::string>& found) {
  struct Figure {
    const char* key;
    const char* words;
    double means_s;
  };
  const double sample_s = 1.0 / diagnosis.sample_rate_hz;
  const std::array<Figure, 4> figures = {{{"residual_rms_radps", "single samples", sample_s},
                                          {"rms_1s_radps", "1 s means grow", 1.0},
                                          {"rms_10s_radps", "10 s means grow", 10.0},
                                          {"rms_100s_radps", "100 s means grow", 100.0}}};
  for (const Figure& figure : figures) {
    const auto before = diagnosis.before.find(figure.key), after = diagnosis.after.find(figure.key);
    if (before == diagnosis.before.end() || after->second <= 1.02 * before->second) continue;
    const bool many = samples * sample_s / figure.means_s >= 100.0;
    if (many || !said(diagnosis, figure.words)) found.push_back(std::string(figure.key) + " grew");
  }
}

}  // namespace

std::vector<std::string> contradictions(const Diagnosis& diagnosis, const std::vector<Capture>& captures) {
  std::vector<std::string> found;
  if (diagnosis.effects.empty()) return found;
  growing(diagnosis, static_cast<double>(diagnosis.samples), found);
  double explained = 0.0;
  for (const FoundEffect& each : diagnosis.effects) explained += each.variance_explained;
  if (diagnosis.unexplained.fraction >= 0.95 && explained > 1.0 / 3.0)
    found.emplace_back("all unexplained beside what explains it");
  Model model;
  add_to_model(diagnosis, "", model);
  const auto promised = diagnosis.after.find("rms_10s_radps");
  const double before = rms_of_means(captures[0], left_by({}, captures[0]));
  if (captures.size() == 1 && promised != diagnosis.after.end() &&
      before <= 1.2 * diagnosis.before.at("rms_10s_radps") &&
      rms_of_means(captures[0], left_by(model, captures[0])) > 1.2 * promised->second)
    found.emplace_back("the model leaves more than was promised");
  for (const FoundEffect& each : diagnosis.effects)
    for (const std::string& remark : diagnosis.remarks)
      if (const auto at = remark.find("were dropped: ");
          !each.effect.channel.empty() && at != std::string::npos)
        if (remark.find(each.effect.channel + " (", at) != std::string::npos)
          found.push_back(each.effect.channel + " is left out and used");
  return found;
}

}  // namespace ifog::undeclared
