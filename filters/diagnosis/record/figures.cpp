// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/figures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "filters/allan/gapped_deviation.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/series/finite_sum.h"

namespace ifog {
namespace {

const double kMissing = std::numeric_limits<double>::quiet_NaN();

double rms_about_mean(std::span<const double> values) { return std::sqrt(variance_of(values, kMissing)); }

double lag_one(std::span<const double> values) {
  const double rms = rms_about_mean(values);
  const auto [all, n] = finite_sum(values);
  if (n < 4.0 || !(rms > 0.0)) return 0.0;
  const double mean = all / n;
  double sum = 0.0, pairs = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double product = (values[i] - mean) * (values[i - 1] - mean);
    if (std::isfinite(product)) sum += product, pairs += 1.0;
  }
  return pairs > 0.0 ? sum / pairs / (rms * rms) : 0.0;
}

double heading_drift(std::span<const double> error, double period_s) {
  const std::size_t aligned = error.size() / 10;
  const auto [sum, n] = finite_sum(error.first(aligned));
  if (n == 0.0) return kMissing;
  const double bias = sum / n;
  double angle = 0.0;
  for (const double each : error.subspan(aligned))
    if (std::isfinite(each)) angle += (each - bias) * period_s;
  return std::abs(angle);
}

}  // namespace

Samples means_over(std::span<const double> error, std::size_t count) {
  Samples means;
  means.reserve(error.size() / count);
  for (std::size_t from = 0; from + count <= error.size(); from += count) {
    double sum = 0.0;
    std::size_t there = 0;
    for (std::size_t i = from; i < from + count; ++i) {
      if (std::isfinite(error[i])) sum += error[i], ++there;
    }
    means.push_back(2 * there >= count ? sum / static_cast<double>(there) : kMissing);
  }
  return means;
}

std::map<std::string, double> error_figures(std::span<const double> error, double period_s) {
  std::map<std::string, double> figures;
  figures["residual_rms_radps"] = rms_about_mean(error);
  std::vector<std::string> names;
  std::vector<std::size_t> counts;
  for (const auto& [tau, name] : {std::pair{0.1, "0.1s_radps"}, std::pair{1.0, "1s_radps"},
                                  std::pair{10.0, "10s_radps"}, std::pair{100.0, "100s_radps"}}) {
    const auto count = static_cast<std::size_t>(std::floor(tau / period_s + 0.5));
    if (count < 1 || error.size() < 10 * count) continue;
    names.emplace_back(name);
    counts.push_back(count);
  }
  const std::vector<double> deviations = gapped_deviation(error, counts);
  const auto second = std::max<std::size_t>(1, static_cast<std::size_t>(std::floor(1.0 / period_s + 0.5)));
  for (std::size_t i = 0; i < counts.size(); ++i) {
    figures["rms_" + names[i]] = rms_about_mean(means_over(error, counts[i]));
    figures["adev_" + names[i]] = deviations[i];
  }
  figures["heading_drift_rad"] = heading_drift(error, period_s);
  const bool long_enough = error.size() >= 20 * second;
  figures["whiteness"] = long_enough ? lag_one(means_over(error, second)) : lag_one(error);
  return figures;
}

std::map<std::string, double> pooled(const std::vector<std::map<std::string, double>>& figures,
                                     const std::vector<double>& weights) {
  std::map<std::string, double> sum;
  std::map<std::string, double> weight;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    for (const auto& [name, value] : figures[i]) {
      if (!std::isfinite(value)) continue;
      sum[name] += weights[i] * (name == "whiteness" ? value : value * value);
      weight[name] += weights[i];
    }
  }
  for (auto& [name, value] : sum) {
    value /= weight[name];
    if (name != "whiteness") value = std::sqrt(value);
  }
  return sum;
}

}  // namespace ifog
