// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/record/known_angles.h"
#include "filters/series/mapped_file.h"
#include "filters/series/series_view.h"

namespace ifog {
namespace {

const double kMissing = std::numeric_limits<double>::quiet_NaN();

double rms_about_mean(std::span<const double> values) {
  const std::optional<double> variance = variance_of_two(values);
  return variance ? std::sqrt(*variance) : kMissing;
}

double lag_one(std::span<const double> values) {
  const double rms = rms_about_mean(values);
  double mean = 0.0;
  double n = 0.0;
  for (const double v : values) {
    if (std::isfinite(v)) {
      mean += v;
      n += 1.0;
    }
  }
  if (n < 4.0 || !(rms > 0.0)) return 0.0;
  mean /= n;
  double sum = 0.0;
  double pairs = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (!std::isfinite(values[i]) || !std::isfinite(values[i - 1])) continue;
    sum += (values[i] - mean) * (values[i - 1] - mean);
    pairs += 1.0;
  }
  return pairs > 0.0 ? sum / pairs / (rms * rms) : 0.0;
}

double heading_drift(std::span<const double> error, double period_s) {
  const std::size_t aligned = error.size() / 10;
  double bias = 0.0;
  double n = 0.0;
  for (std::size_t i = 0; i < aligned; ++i) {
    if (!std::isfinite(error[i])) continue;
    bias += error[i];
    n += 1.0;
  }
  if (n == 0.0) return kMissing;
  bias /= n;
  double angle = 0.0;
  for_each_piece(error, aligned, error.size(), [&](std::span<const double> some, std::size_t) {
    for (const double each : some)
      if (std::isfinite(each)) angle += (each - bias) * period_s;
  });
  return std::abs(angle);
}

}  // namespace

// Four sums, so that no addition waits for the one before; one look at a time where something is missing.
Present present(std::span<const double> values) {
  constexpr std::size_t kLanes = 4;
  std::array<double, kLanes> lane{};
  std::size_t i = 0;
  for (; i + kLanes <= values.size(); i += kLanes)
    for (std::size_t k = 0; k < kLanes; ++k) lane[k] += values[i + k];
  for (; i < values.size(); ++i) lane[0] += values[i];
  const double all = (lane[0] + lane[1]) + (lane[2] + lane[3]);
  if (std::isfinite(all)) return {all, values.size()};
  Present there;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    there.sum += value;
    ++there.count;
  }
  return there;
}

Samples means_over(std::span<const double> error, std::size_t count) {
  return std::move(means_over(error, std::vector{count}).front());
}

std::vector<Samples> means_over(std::span<const double> error, const std::vector<std::size_t>& counts) {
  std::vector<Samples> means(counts.size());
  std::vector<std::size_t> next(counts.size());
  for (std::size_t c = 0; c < counts.size(); ++c) means[c].reserve(error.size() / counts[c]);
  // A piece is read once for all of them, while it is in the second-level cache.
  constexpr std::size_t kPiece = std::size_t{1} << 16U;
  for (std::size_t from = 0; from < error.size(); from += kPiece) {
    const std::size_t to = std::min(from + kPiece, error.size());
    expect_reading(error.data() + from, (to - from) * sizeof(double));
    for (std::size_t c = 0; c < counts.size(); ++c)
      for (; next[c] + counts[c] <= to; next[c] += counts[c])
        means[c].push_back(present(error.subspan(next[c], counts[c])).mean_of(counts[c]));
  }
  return means;
}

std::map<std::string, double> error_figures(std::span<const double> error, double period_s) {
  KnownAngles none;
  return error_figures(error, period_s, none);
}

std::map<std::string, double> error_figures(const AskedSeries& asked, double period_s, KnownAngles& angles) {
  const std::span<const double> error = asked.values();
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
  const std::vector<double> deviations = angles.gapped(asked, counts);
  const auto second = std::max<std::size_t>(1, static_cast<std::size_t>(std::floor(1.0 / period_s + 0.5)));
  std::vector<std::size_t> with_second = counts;
  with_second.push_back(second);
  const std::vector<Samples> means = means_over(error, with_second);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    figures["rms_" + names[i]] = rms_about_mean(means[i]);
    figures["adev_" + names[i]] = deviations[i];
  }
  figures["heading_drift_rad"] = heading_drift(error, period_s);
  const bool long_enough = error.size() >= 20 * second;
  figures["whiteness"] = long_enough ? lag_one(means.back()) : lag_one(error);
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
