// SPDX-License-Identifier: Apache-2.0
#include "filters/tune/spectrum.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "filters/linear/fourier.h"

namespace ifog {
namespace {

constexpr double kPi = std::numbers::pi;
// Number of single-ordinate bins; wider bins have 1/50 of their index, at most 1/1024 of the band.
constexpr std::size_t kSingle = 64;
constexpr std::size_t kRelative = 50;
constexpr std::size_t kAcross = 1024;

std::vector<double> bridged(std::span<const double> values) {
  std::vector<double> out(values.begin(), values.end());
  std::size_t last = out.size();
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (!std::isfinite(out[k])) continue;
    const std::size_t from = last == out.size() ? 0 : last;
    const double begin = last == out.size() ? out[k] : out[last];
    for (std::size_t i = from; i < k; ++i)
      out[i] = begin + (out[k] - begin) * static_cast<double>(i - from) / static_cast<double>(k - from);
    last = k;
  }
  if (last == out.size()) std::ranges::fill(out, 0.0);
  for (std::size_t k = last; k < out.size(); ++k) out[k] = out[last];
  return out;
}

// Squares of the orthonormal cosine transform, by a Fourier transform of the same length (Makhoul, IEEE
// Trans. ASSP 28, 1980).
std::vector<double> cosine_squares(std::span<const double> values) {
  const std::size_t n = values.size();
  std::vector<double> folded(n);
  for (std::size_t i = 0; 2 * i < n; ++i) folded[i] = values[2 * i];
  for (std::size_t i = 0; 2 * i + 1 < n; ++i) folded[n - 1 - i] = values[2 * i + 1];
  std::vector<std::complex<double>> bins;
  Fourier().forward(bins, folded);
  std::vector<double> squares(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double turn = -kPi * static_cast<double>(k) / (2.0 * static_cast<double>(n));
    const double value = (bins[k] * std::polar(1.0, turn)).real();
    squares[k] = value * value * (k == 0 ? 1.0 : 2.0) / static_cast<double>(n);
  }
  return squares;
}

}  // namespace

RecordSpectrum spectrum_of(std::span<const std::vector<double>> axes) {
  RecordSpectrum s;
  s.samples = smooth_length(axes[0].size());
  std::vector<double> mean(s.samples, 0.0);
  for (const auto& axis : axes) {
    const std::vector<double> squares = cosine_squares(bridged(std::span(axis).first(s.samples)));
    for (std::size_t k = 0; k < s.samples; ++k) mean[k] += squares[k] / static_cast<double>(axes.size());
  }
  for (std::size_t k = 1; k < s.samples;) {
    const std::size_t relative = std::max<std::size_t>(1, k / kRelative);
    const std::size_t width =
        k < kSingle ? 1 : std::min(relative, std::max<std::size_t>(1, s.samples / kAcross));
    const std::size_t end = std::min(k + width, s.samples);
    double sum = 0.0;
    for (std::size_t i = k; i < end; ++i) sum += mean[i];
    const auto count = static_cast<double>(end - k);
    s.omega.push_back(kPi * 0.5 * static_cast<double>(k + end - 1) / static_cast<double>(s.samples));
    // Avoids the logarithm of zero for a record with few digits.
    s.density.push_back(std::max(sum / count, 1e-300));
    s.ordinates.push_back(count * static_cast<double>(axes.size()));
    k = end;
  }
  for (const double omega : s.omega) s.walk.push_back(0.25 / std::pow(std::sin(0.5 * omega), 2));
  for (std::size_t order = 0; order < RecordSpectrum::kOrders; ++order) {
    for (const double omega : s.omega) {
      s.cosine[order].push_back(std::cos(static_cast<double>(order + 1) * omega));
      s.sine[order].push_back(std::sin(static_cast<double>(order + 1) * omega));
    }
  }
  return s;
}

}  // namespace ifog
