// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/periodogram.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "filters/diagnosis/residual/paired_transform.h"
#include "filters/series/series_view.h"

namespace ifog {
namespace {

using Complex = std::complex<double>;

bool is_smooth(std::size_t length) {
  for (const std::size_t prime : {2U, 3U, 5U})
    while (length % prime == 0) length /= prime;
  return length == 1;
}

Samples power_in_memory(std::span<const double> error, double mean) {
  std::vector<double> values(error.size());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::isfinite(error[i]) ? error[i] - mean : 0.0;
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<Complex> bins;
  fft.fwd(bins, values);
  Samples power(bins.size());
  for (std::size_t k = 0; k < bins.size(); ++k) power[k] = std::norm(bins[k]);
  return power;
}

}  // namespace

double mean_of_present(std::span<const double> values) {
  double sum = 0.0;
  std::size_t n = 0;
  for_each_piece(values, 0, values.size(), [&](std::span<const double> some, std::size_t) {
    for (const double v : some) {
      if (!std::isfinite(v)) continue;
      sum += v;
      ++n;
    }
  });
  return n ? sum / static_cast<double>(n) : 0.0;
}

Periodogram periodogram(std::span<const double> error, std::size_t in_memory) {
  const bool pairs = error.size() > in_memory;
  Periodogram out;
  out.length = error.size();
  while (out.length > 16 && (!is_smooth(out.length) || (pairs && out.length % 2 != 0))) --out.length;
  out.mean = mean_of_present(error);
  const std::span<const double> used = error.first(out.length);
  out.power = pairs ? PairedTransform(used, out.mean).power() : power_in_memory(used, out.mean);
  return out;
}

}  // namespace ifog
