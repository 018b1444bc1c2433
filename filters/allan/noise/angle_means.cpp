// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/noise/angle_means.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>

namespace ifog {
namespace {

// Means of this level are stored; higher levels are computed from them.
constexpr int kStored = 5;
// From this level on a mean over angles equals a mean over time for the covariance.
constexpr int kFinest = 6;

std::size_t angles_of(int level) { return std::size_t{1} << static_cast<unsigned>(level); }

double mean_of(std::span<const double> part) {
  return std::accumulate(part.begin(), part.end(), 0.0) / static_cast<double>(part.size());
}

// Generalised covariance of the rate samples for one unit of each term.
TermVariances covariance_of_rate(std::size_t lag) {
  const auto t = static_cast<double>(lag);
  const double flicker =
      2.0 * covariance_of_angle(t)[kB] - covariance_of_angle(t + 1.0)[kB] - covariance_of_angle(t - 1.0)[kB];
  return {0.0, lag == 0 ? 1.0 : 0.0, flicker, lag == 0 ? -1.0 / 6.0 : -0.5 * t};
}

using LevelCovariance = std::array<TermVariances, kLevelLags>;

// A rate of a level is a triangle-weighted sum of samples. Its covariance is that of the samples, convolved
// with the triangle's autocorrelation.
LevelCovariance covariance_at(int level, std::span<const TermVariances> of_rate) {
  const std::size_t step = angles_of(level), width = 2 * step - 1;
  std::vector<double> triangle(width), weight(2 * width - 1);
  for (std::size_t i = 0; i < width; ++i)
    triangle[i] = static_cast<double>(std::min(i + 1, width - i)) /
                  (static_cast<double>(step) * static_cast<double>(step));
  for (std::size_t i = 0; i < width; ++i)
    for (std::size_t j = 0; j < width; ++j) weight[i + width - 1 - j] += triangle[i] * triangle[j];
  const TermVariances unit = level_unit(level);
  LevelCovariance covariance{};
  for (std::size_t lag = 0; lag < kLevelLags; ++lag) {
    for (std::size_t d = 0; d < weight.size(); ++d) {
      const std::size_t to = lag * step + d, from = width - 1;
      const TermVariances& c = of_rate[to > from ? to - from : from - to];
      for (const Term t : {kN, kB, kK}) covariance[lag][t] += weight[d] * c[t] / unit[t];
    }
  }
  covariance[0][kQ] = 2.0;
  covariance[1][kQ] = -1.0;
  return covariance;
}

std::vector<LevelCovariance> all_levels() {
  std::vector<TermVariances> of_rate;
  for (std::size_t lag = 0; lag < (kLevelLags + 2) * angles_of(kFinest); ++lag)
    of_rate.push_back(covariance_of_rate(lag));
  std::vector<LevelCovariance> levels;
  for (int level = 0; level <= kFinest; ++level) levels.push_back(covariance_at(level, of_rate));
  return levels;
}

}  // namespace

AngleMeans::AngleMeans(std::span<const double> angle, std::size_t first, std::size_t angles)
    : angle_(angle), first_(first), angles_(angles) {
  constexpr std::size_t kMany = std::size_t{1} << kStored;
  stored_.reserve(angles / kMany);
  for (std::size_t i = 0; i + kMany <= angles; i += kMany)
    stored_.push_back(mean_of(angle.subspan(first + i, kMany)));
}

std::size_t AngleMeans::rates(int level) const {
  const std::size_t means = angles_ / angles_of(level);
  return means > 0 ? means - 1 : 0;
}

void AngleMeans::rates(int level, std::size_t begin, std::span<double> rate) const {
  const bool fine = level < kStored;
  const std::size_t many = angles_of(fine ? level : level - kStored), count = (rate.size() + 1) * many;
  const std::span<const double> from =
      fine ? angle_.subspan(first_ + begin * many, count) : std::span(stored_).subspan(begin * many, count);
  const auto step = static_cast<double>(angles_of(level));
  double before = mean_of(from.subspan(0, many));
  for (std::size_t i = 0; i < rate.size(); ++i) {
    const double now = mean_of(from.subspan((i + 1) * many, many));
    rate[i] = (now - before) / step;
    before = now;
  }
}

std::span<const TermVariances> level_covariance(int level) {
  static const std::vector<LevelCovariance> kLevels = all_levels();
  return kLevels[static_cast<std::size_t>(std::min(level, kFinest))];
}

TermVariances level_unit(int level) {
  const auto step = static_cast<double>(angles_of(level));
  return {1.0 / (step * step * step), 1.0 / step, 1.0, step};
}

}  // namespace ifog
