// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/resonances.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "filters/series/mapped_file.h"

namespace ifog {
namespace {

// Sixteen pieces average to within a few times of the mean: ten times the median around is no chance.
constexpr double kClear = 10.0;
constexpr std::size_t kLeastPieces = 16;
constexpr std::size_t kLeastPiece = 1024;
constexpr std::size_t kMostPiece = 16384;
constexpr std::size_t kMost = 8;
// What is around a peak lies between these factors of its frequency; a peak is the highest within the first.
constexpr double kNear = 1.1;
constexpr double kFar = 1.6;

// Hann windows that overlap by half (Welch 1967). Not scaled.
std::vector<double> averaged_power(std::span<const double> error, std::size_t piece) {
  std::vector<double> power(piece / 2 + 1, 0.0);
  std::vector<double> values(piece), window(piece);
  for (std::size_t i = 0; i < piece; ++i)
    window[i] =
        0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(piece));
  std::vector<std::complex<double>> bins;
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  for (std::size_t from = 0; from + piece <= error.size(); from += piece / 2) {
    expect_reading(error.data() + from, piece * sizeof(double));
    double mean = 0.0;
    double n = 0.0;
    for (std::size_t i = 0; i < piece; ++i) {
      if (!std::isfinite(error[from + i])) continue;
      mean += error[from + i];
      n += 1.0;
    }
    mean = n > 0.0 ? mean / n : 0.0;
    for (std::size_t i = 0; i < piece; ++i)
      values[i] = std::isfinite(error[from + i]) ? window[i] * (error[from + i] - mean) : 0.0;
    fft.fwd(bins, values);
    for (std::size_t k = 0; k < power.size(); ++k) power[k] += std::norm(bins[k]);
  }
  return power;
}

}  // namespace

std::vector<Resonance> find_resonances(std::span<const double> error, double period_s) {
  std::size_t piece = kMostPiece;
  while (piece > kLeastPiece && error.size() < kLeastPieces * piece) piece /= 2;
  if (error.size() < kLeastPieces * piece) return {};
  const std::vector<double> power = averaged_power(error, piece);
  std::vector<Resonance> found;
  std::vector<double> around;
  for (std::size_t k = 16; static_cast<double>(k) * kFar < static_cast<double>(power.size()); ++k) {
    const auto at = static_cast<double>(k);
    const auto low = static_cast<std::size_t>(at / kNear);
    const auto high = static_cast<std::size_t>(at * kNear) + 1;
    if (power[k] < *std::max_element(power.begin() + static_cast<std::ptrdiff_t>(low),
                                     power.begin() + static_cast<std::ptrdiff_t>(high) + 1))
      continue;
    around.assign(power.begin() + static_cast<std::ptrdiff_t>(at / kFar),
                  power.begin() + static_cast<std::ptrdiff_t>(low));
    around.insert(around.end(), power.begin() + static_cast<std::ptrdiff_t>(high) + 1,
                  power.begin() + static_cast<std::ptrdiff_t>(at * kFar));
    const auto middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
    std::nth_element(around.begin(), middle, around.end());
    if (!(power[k] > kClear * *middle)) continue;
    found.push_back({at / (static_cast<double>(piece) * period_s), power[k] / *middle});
  }
  std::sort(found.begin(), found.end(),
            [](const Resonance& a, const Resonance& b) { return a.ratio > b.ratio; });
  if (found.size() > kMost) found.resize(kMost);
  return found;
}

std::string resonances_in_words(const std::vector<Resonance>& found) {
  if (found.empty()) return "";
  std::vector<double> frequencies;
  frequencies.reserve(found.size());
  for (const Resonance& each : found) frequencies.push_back(each.frequency_hz);
  std::sort(frequencies.begin(), frequencies.end());
  std::string list;
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    std::string number = std::to_string(frequencies[i]);
    number.resize(number.find('.') + 3);
    list += (i == 0 ? "" : i + 1 == frequencies.size() ? " and " : ", ") + number;
  }
  return "the spectrum stands up at " + list +
         " Hz: resonances of the mounting or the structure, or lines that come and go. That is motion and "
         "stays in the rate";
}

}  // namespace ifog
