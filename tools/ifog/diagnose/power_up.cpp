// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/diagnose/power_up.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace ifog::tools {
namespace {

constexpr double kSame_s = 1.0;
// Time constants after which a warm-up is too small to extrapolate to power-up.
constexpr double kLongPast = 3.0;

ModelParameter* named(Effect& effect, const char* name, std::size_t& at) {
  for (at = 0; at < effect.parameters.size(); ++at)
    if (effect.parameters[at].name == name) return &effect.parameters[at];
  return nullptr;
}

// Replaces row and column `to` of an n x n matrix by scale times itself plus slope times `with`.
void transform(std::vector<double>& matrix, std::size_t n, std::size_t to, std::size_t with, double scale,
               double slope) {
  for (std::size_t i = 0; i < n; ++i)
    matrix[to * n + i] = scale * matrix[to * n + i] + slope * matrix[with * n + i];
  for (std::size_t i = 0; i < n; ++i)
    matrix[i * n + to] = scale * matrix[i * n + to] + slope * matrix[i * n + with];
}

}  // namespace

std::optional<double> began_after_power_up(const std::vector<CaptureView>& captures, double fit_from) {
  if (captures.empty() || !captures.front().since_power_up_s) return std::nullopt;
  const auto fitted_from = [&](const CaptureView& each) {
    const double length_s = each.time_s.empty() ? 0.0 : each.time_s.back() - each.time_s.front();
    return *each.since_power_up_s + fit_from * length_s;
  };
  const double first = fitted_from(captures.front());
  const bool same = std::all_of(captures.begin(), captures.end(), [&](const CaptureView& each) {
    return each.since_power_up_s && std::abs(fitted_from(each) - first) <= kSame_s;
  });
  return same ? std::optional(first) : std::nullopt;
}

void count_from_power_up(Diagnosis& diagnosis, double began_s) {
  std::size_t n = 0, row = 0;
  for (const FoundEffect& each : diagnosis.effects) n += each.effect.parameters.size();
  for (FoundEffect& found : diagnosis.effects) {
    Effect& effect = found.effect;
    const std::size_t first = row;
    row += effect.parameters.size();
    std::size_t c = 0, t = 0;
    ModelParameter* const coefficient = named(effect, "coefficient", c);
    const ModelParameter* const time = named(effect, "time_constant_s", t);
    if (effect.form != "warm_up" || coefficient == nullptr || time == nullptr) continue;
    if (began_s > kLongPast * time->value) {
      effect.shown_only = true;
      effect.meaning =
          "the bias settles exponentially after the start of the record, when the sensor had long been on";
      diagnosis.remarks.emplace_back(
          "what settles after the start of the record is shown and not corrected: the sensor had been on for "
          "over three of its time constants, and what it was at power-up the record does not say; record "
          "from power-up "
          "on");
      continue;
    }
    effect.meaning = "warm-up: the bias settles exponentially after power-up";
    const double scale = std::exp(began_s / time->value);
    const double slope = -coefficient->value * scale * began_s / (time->value * time->value);
    coefficient->value *= scale;
    coefficient->std_error *= scale;
    if (diagnosis.covariance.size() != n * n) continue;
    transform(diagnosis.covariance, n, first + c, first + t, scale, slope);
    const double variance = diagnosis.covariance[(first + c) * n + first + c];
    if (variance > 0.0) coefficient->std_error = std::sqrt(variance);
  }
}

}  // namespace ifog::tools
