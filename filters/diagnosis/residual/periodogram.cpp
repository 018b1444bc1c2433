// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/periodogram.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/row_times/median.h"
#include "filters/linear/fourier.h"
#include "filters/series/finite_sum.h"

namespace ifog {
Periodogram periodogram(std::span<const double> error) {
  Periodogram out;
  out.length = smooth_length(std::min(error.size(), kMostTransformed));
  const auto [sum, present] = finite_sum(error);
  out.mean = present > 0.0 ? sum / present : 0.0;
  std::vector<double> values(out.length);
  for (std::size_t i = 0; i < out.length; ++i)
    values[i] = std::isfinite(error[i]) ? error[i] - out.mean : 0.0;
  out.power = power_spectrum(values);
  // Missing samples have no power.
  for (double& power : out.power) power *= static_cast<double>(error.size()) / std::max(1.0, present);
  return out;
}

NoiseFloor::NoiseFloor(std::span<const double> power) {
  // Noise is estimated from ±15 % of the frequency, and a minimum number of bins.
  constexpr double kBand = 0.15;
  constexpr std::size_t kLeastBins = 25;
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
  const auto j = static_cast<std::size_t>(above - at_.begin()) - 1;
  const bool inside = j + 1 < at_.size();
  const double next = inside ? value_[j + 1] : value_[j];
  const double span = inside ? static_cast<double>(at_[j + 1] - at_[j]) : 1.0;
  const double share = bin > at_[j] ? std::min(1.0, static_cast<double>(bin - at_[j]) / span) : 0.0;
  return std::max(value_[j] + share * (next - value_[j]), 1e-300);
}

std::vector<std::size_t> peaks_of(const Periodogram& spectrum, const NoiseFloor& floor, double significance) {
  const std::vector<double>& power = spectrum.power;
  constexpr std::size_t kFirstBin = 16;  // below, a line cannot be distinguished from slow noise
  constexpr double kLeastOfLines = 0.6;  // smallest share of a line's power in its nearest bin
  const double least = -kLeastOfLines * std::log(significance / static_cast<double>(power.size()));
  std::vector<std::size_t> peaks;
  for (std::size_t k = kFirstBin; k + 1 < power.size(); ++k)
    if (power[k] >= power[k - 1] && power[k] >= power[k + 1] && power[k] > least * floor[k])
      peaks.push_back(k);
  std::ranges::sort(peaks,
                    [&](std::size_t a, std::size_t b) { return power[a] / floor[a] > power[b] / floor[b]; });
  return peaks;
}

Spectrum averaged(const Periodogram& of, double period_s, std::size_t points) {
  Spectrum spectrum;
  const std::vector<double>& power = of.power;
  const auto length = static_cast<double>(of.length);
  const double growth = std::pow(static_cast<double>(power.size()), 1.0 / static_cast<double>(points));
  for (std::size_t k = 1; k < power.size();) {
    const auto next = std::max(k + 1, static_cast<std::size_t>(static_cast<double>(k) * growth));
    const std::size_t end = std::min(next, power.size());
    double sum = 0.0;
    for (std::size_t i = k; i < end; ++i) sum += power[i];
    spectrum.frequency_hz.push_back(0.5 * static_cast<double>(k + end - 1) / (length * period_s));
    spectrum.density.push_back(2.0 * period_s / length * sum / static_cast<double>(end - k));
    k = end;
  }
  return spectrum;
}

}  // namespace ifog
