// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/ramp/ramp_between_captures.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "filters/diagnosis/ramp/harmonic_sums.h"

namespace ifog {
namespace {

constexpr double kCertainlyAnother =
    60.0;  // twice the log-likelihood, of the harmonics there and over those that stand
// The rate as measured has a bias, which the ramp need not share, and another one from capture to
// capture: k is as uncertain.
constexpr double kBiased = 0.02;
constexpr double kApart = 2.0;  // such reaches, between where lines would move and where they would stand
constexpr double kAlike = 3.0;  // factor of the amplitude, in angle, from capture to capture
constexpr std::size_t kComparedHarmonics = 8;  // harmonics
constexpr double kOneCentre = 4.0;             // widths of a line to either side

struct Best {
  double cycles_per_rad = 0.0, energy = 0.0;
  double usual = 0.0;  // energy of the same harmonics at the other k: of the noise around them
};

// Largest energy of the harmonics together at a k within `reach`; width: of a line.
Best best_near(const UnbrokenPart& part, const std::vector<double>& angle, double k, double reach,
               double width, std::size_t harmonics) {
  Best best;
  std::vector<double> energies;
  const double step = width / (8.0 * static_cast<double>(harmonics));
  for (double centre = k - reach; centre <= k + reach; centre += 2.0 * kOneCentre * width) {
    const HarmonicSums sums(part, angle, centre, harmonics);
    for (double at = centre - kOneCentre * width; at < centre + kOneCentre * width; at += step) {
      double energy = 0.0;
      for (std::size_t h = 1; h <= sums.harmonics(); ++h) energy += sums.explained(h, at);
      energies.push_back(energy);
      if (energy > best.energy) best = {at, energy};
    }
  }
  const auto middle = energies.begin() + static_cast<std::ptrdiff_t>(energies.size() / 2);
  std::nth_element(energies.begin(), middle, energies.end());
  best.usual = *middle;
  return best;
}

// Over the angle as measured, or as turned at the mean rate: the noise of the rate is in the ramp of a
// closed loop that follows what it measures, and not in that of one that follows the rotation.
Best best_near(const UnbrokenPart& part, double k, double reach, double width, std::size_t harmonics) {
  const Best measured = best_near(part, part.angle_rad, k, reach, width, harmonics);
  const Best even = best_near(part, evenly_turned(part), k, reach, width, harmonics);
  return measured.energy > even.energy ? measured : even;
}

double span_of(const UnbrokenPart& part) {
  const auto [low, high] = std::minmax_element(part.angle_rad.begin(), part.angle_rad.end());
  return *high - *low;
}

// Mean square of the comb as an angle: of the rate it grows with the rate itself.
double as_angle(double energy, const UnbrokenPart& part) {
  const double turn = part.mean_turn_rad();
  return energy / static_cast<double>(part.size()) / (turn * turn);
}

}  // namespace

RampBetween follow_comb(const UnbrokenPart& first, const RampComb& comb, const UnbrokenPart& other) {
  RampBetween found;
  const double k = comb.cycles_per_rad;
  const VisibleCycles visible = visible_cycles(other);
  if (!(visible.least < k && k < visible.most)) return found;
  const std::size_t harmonics = std::min(comb.harmonics, kComparedHarmonics);
  const double width = 1.0 / span_of(other);
  const double narrow = width + 1.0 / span_of(first);
  const double reach = narrow + kBiased * k;
  const double standing =
      k * std::abs(first.mean_turn_rad() / other.mean_turn_rad()) * other.sample_s / first.sample_s;
  if (std::abs(standing - k) < kApart * reach) return found;
  const Best best = best_near(other, k, reach, width, harmonics);
  const Best fixed = best_near(other, standing, narrow, width, harmonics);
  const Best here = best_near(first, k, 0.0, 1.0 / span_of(first), harmonics);
  // Noise gives two to each harmonic.
  const double one = std::max(best.usual, 1e-300) / (2.0 * static_cast<double>(harmonics));
  found.cycles_per_rad = best.cycles_per_rad;
  found.gain = (best.energy - best.usual) / one;
  found.over_standing = (best.energy - fixed.energy) / one;
  const double size = as_angle(best.energy, other) / std::max(as_angle(here.energy, first), 1e-300);
  found.moves = found.gain > kCertainlyAnother && found.over_standing > kCertainlyAnother &&
                size < kAlike * kAlike && size > 1.0 / (kAlike * kAlike);
  return found;
}

}  // namespace ifog
