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

using LevelCovariance = std::array<TermVariances, kLevelLags>;

// The rate is the second difference of the angle's running sum at the level's step.
LevelCovariance covariance_at(int level) {
  const double step = static_cast<double>(angles_of(level)), step4 = step * step * step * step;
  const TermVariances unit = level_unit(level);
  LevelCovariance covariance{};
  for (std::size_t lag = 0; lag < kLevelLags; ++lag) {
    const TermVariances of_sum =
        covariance_of_sum_differences(angles_of(level), static_cast<double>(lag) * step);
    for (std::size_t t = 0; t < kTerms; ++t) covariance[lag][t] = of_sum[t] / (step4 * unit[t]);
  }
  return covariance;
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
  static const std::vector<LevelCovariance> kLevels = [] {
    std::vector<LevelCovariance> levels;
    for (int each = 0; each <= kFinest; ++each) levels.push_back(covariance_at(each));
    return levels;
  }();
  return kLevels[static_cast<std::size_t>(std::min(level, kFinest))];
}

TermVariances level_unit(int level) {
  const auto step = static_cast<double>(angles_of(level));
  return {1.0 / (step * step * step), 1.0 / step, 1.0, step};
}

}  // namespace ifog
