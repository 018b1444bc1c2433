// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/before_and_after.h"

#include <algorithm>
#include <cmath>

#include "filters/diagnosis/record/figures.h"

namespace ifog {

void write_before_and_after(const std::vector<EvenError>& errors, double sample_s, KnownFigures& known,
                            KnownAngles& angles, Diagnosis& diagnosis, bool with_bias) {
  const auto figures_of = [&](const SharedSamples& error) {
    return known.of(error, [&](std::span<const double>) { return error_figures(error, sample_s, angles); });
  };
  std::vector<std::map<std::string, double>> before;
  std::vector<std::map<std::string, double>> written;
  std::vector<std::map<std::string, double>> held_out;
  std::vector<std::map<std::string, double>> logged;
  std::vector<double> weight;
  for (const EvenError& error : errors) {
    before.push_back(figures_of(error.before));
    written.push_back(figures_of(error.written));
    held_out.push_back(figures_of(error.held_out));
    if (!error.logged.empty()) logged.push_back(figures_of(error.logged));
    weight.push_back(static_cast<double>(error.before.size()));
  }
  const auto add_mean = [&](SharedSamples EvenError::*of, std::map<std::string, double>& figures) {
    double sum = 0.0, n = 0.0;
    for (const EvenError& error : errors)
      for (const double value : error.*of)
        if (std::isfinite(value)) sum += value, n += 1.0;
    if (n > 0.0) figures["bias_radps"] = sum / n;
  };
  diagnosis.before = pooled(before, weight);
  diagnosis.after = pooled(written, weight);
  const auto take_worse = [&](const std::map<std::string, double>& others) {
    for (const auto& [name, value] : others) {
      double& figure = diagnosis.after[name];
      if (std::abs(value) > std::abs(figure)) figure = value;
    }
  };
  take_worse(pooled(held_out, weight));
  if (logged.size() == errors.size()) take_worse(pooled(logged, weight));
  if (!with_bias) return;
  add_mean(&EvenError::before, diagnosis.before);
  add_mean(&EvenError::written, diagnosis.after);
}

void balance_shares(std::size_t jointly, Diagnosis& diagnosis) {
  const std::size_t count = std::min(jointly, diagnosis.effects.size());
  const double left = std::clamp(1.0 - diagnosis.unexplained.fraction, 0.0, 1.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) sum += diagnosis.effects[i].variance_explained;
  if (sum <= left) return;
  for (std::size_t i = 0; i < count; ++i) diagnosis.effects[i].variance_explained *= left / sum;
}

}  // namespace ifog
