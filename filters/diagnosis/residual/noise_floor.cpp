// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/noise_floor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "filters/diagnosis/record/words.h"
#include "filters/series/series_view.h"

namespace ifog {
namespace {

constexpr double kBand = 0.15;  // noise is taken from +-15 % of the frequency, and at least
constexpr std::size_t kLeastBins = 25;

}  // namespace

NoiseFloor::NoiseFloor(std::span<const double> power) {
  std::vector<double> window;
  for (std::size_t k = 1; k < power.size(); k += std::max<std::size_t>(1, k / 50)) {
    const std::size_t half = std::max(kLeastBins, static_cast<std::size_t>(kBand * static_cast<double>(k)));
    const std::size_t low = k > half ? k - half : 1;
    const std::size_t high = std::min(power.size(), k + half + 1);
    const std::size_t stride = std::max<std::size_t>(1, (high - low) / 2000);
    window.clear();
    for (std::size_t i = low; i < high; i += stride) window.push_back(power[i]);
    at_.push_back(k);
    value_.push_back(median(window) / std::numbers::ln2);
  }
}

double NoiseFloor::operator[](std::size_t bin) const {
  const auto above = std::upper_bound(at_.begin() + 1, at_.end(), bin);
  return between(static_cast<std::size_t>(above - at_.begin()) - 1, bin);
}

double NoiseFloor::following(std::size_t bin, std::size_t& j) const {
  while (j + 1 < at_.size() && at_[j + 1] <= bin) ++j;
  return between(j, bin);
}

double NoiseFloor::between(std::size_t j, std::size_t bin) const {
  const bool inside = j + 1 < at_.size();
  const double next = inside ? value_[j + 1] : value_[j];
  const double span = inside ? static_cast<double>(at_[j + 1] - at_[j]) : 1.0;
  const double share = bin > at_[j] ? std::min(1.0, static_cast<double>(bin - at_[j]) / span) : 0.0;
  return std::max(value_[j] + share * (next - value_[j]), 1e-300);
}

SpectralPeaks::SpectralPeaks(std::span<const double> power) : floor(power) {
  const double least = kLeastOfLines * std::log(static_cast<double>(power.size()));
  double before = power[kFirstBinOfLines - 1];
  std::size_t near = 0;
  for_each_piece(power, kFirstBinOfLines, power.size() - 1,
                 [&](std::span<const double> some, std::size_t first) {
                   for (std::size_t i = 0; i < some.size(); ++i) {
                     const double now = some[i];
                     const bool peak = now >= before && now >= power[first + i + 1];
                     before = now;
                     if (!peak) continue;
                     const double ratio = now / floor.following(first + i, near);
                     if (ratio > least) peaks.push_back({first + i, ratio});
                   }
                 });
}

}  // namespace ifog
