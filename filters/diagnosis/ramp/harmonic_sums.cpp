// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/ramp/harmonic_sums.h"

#include <cmath>

#include "filters/diagnosis/ramp/carrier.h"

namespace ifog {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t kPieces = 512;

}  // namespace

HarmonicSums::HarmonicSums(const UnbrokenPart& part, const std::vector<double>& angle_rad,
                           double cycles_per_rad, std::size_t harmonics)
    : cycles_per_rad_(cycles_per_rad),
      samples_(angle_rad.size()),
      sums_(harmonics * kPieces),
      middle_rad_(kPieces),
      carrier_(harmonics),
      norm_(harmonics) {
  for (std::size_t p = 0; p < kPieces; ++p) {
    const std::size_t from = 1 + p * (samples_ - 1) / kPieces;
    const std::size_t to = 1 + (p + 1) * (samples_ - 1) / kPieces;
    middle_rad_[p] = 0.5 * (angle_rad[from - 1] + angle_rad[to - 1]);
    for (std::size_t i = from; i < to; ++i) {
      const double error = part.error_radps[i];
      square_ += error * error;
      const Complex before = carrier_of(cycles_per_rad * angle_rad[i - 1]);
      const Complex now = carrier_of(cycles_per_rad * angle_rad[i]);
      Complex power_before = 1.0;
      Complex power_now = 1.0;
      for (std::size_t h = 0; h < harmonics; ++h) {
        power_before *= before;
        power_now *= now;
        const Complex rate = (power_now - power_before) / part.sample_s;
        sums_[h * kPieces + p] += error * std::conj(rate);
        norm_[h] += std::norm(rate);
        carrier_[h] += power_now / static_cast<double>(samples_);
      }
    }
  }
  for (std::size_t h = 0; h < harmonics; ++h)
    if (part.stroboscopic(cycles_per_rad, h + 1)) norm_[h] = 0.0;
}

double HarmonicSums::standing(std::size_t harmonic) const { return std::abs(carrier_[harmonic - 1]); }

double HarmonicSums::explained(std::size_t harmonic, double cycles_per_rad) const {
  const double off = static_cast<double>(harmonic) * (cycles_per_rad - cycles_per_rad_);
  Complex total = 0.0;
  const Complex* const sums = sums_.data() + (harmonic - 1) * kPieces;
  for (std::size_t p = 0; p < kPieces; ++p) total += sums[p] * carrier_of(-off * middle_rad_[p]);
  return norm_[harmonic - 1] > 0.0 ? 2.0 * std::norm(total) / norm_[harmonic - 1] : 0.0;
}

}  // namespace ifog
