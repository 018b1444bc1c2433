// SPDX-License-Identifier: Apache-2.0
#include "filters/tune/lines.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "filters/linear/fourier.h"

namespace ifog {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
// Bins at the slow end that a walk of the level fills.
constexpr std::size_t kSlow = 8;
// Bins to either side whose median is the noise a peak stands in.
constexpr std::size_t kBeside = 32;

std::vector<double> tapered_power(const std::vector<std::vector<double>>& axes) {
  const std::size_t n = axes[0].size();
  std::vector<double> power(n / 2 + 1, 0.0);
  for (const auto& axis : axes) {
    double mean = 0.0;
    for (const double v : axis) mean += v / static_cast<double>(n);
    std::vector<double> tapered(n);
    for (std::size_t k = 0; k < n; ++k)
      tapered[k] = (axis[k] - mean) *
                   (0.5 - 0.5 * std::cos(kTurn * (static_cast<double>(k) + 0.5) / static_cast<double>(n)));
    const std::vector<double> of_axis = power_spectrum(tapered);
    for (std::size_t k = 0; k < power.size(); ++k) power[k] += of_axis[k];
  }
  return power;
}

// The bin that stands highest above the noise next to it.
std::size_t highest(const std::vector<double>& power) {
  std::size_t best = std::min(kSlow, power.size() - 1);
  double most = -1.0;
  std::vector<double> beside;
  for (std::size_t k = kSlow; k < power.size(); ++k) {
    // Only local maxima are worth a median.
    if (power[k] < power[k - 1] || (k + 1 < power.size() && power[k] < power[k + 1])) continue;
    const std::size_t from = std::max(kSlow, k > kBeside ? k - kBeside : 0);
    const std::size_t to = std::min(power.size(), k + kBeside + 1);
    beside.assign(power.begin() + static_cast<std::ptrdiff_t>(from),
                  power.begin() + static_cast<std::ptrdiff_t>(to));
    const auto middle = beside.begin() + static_cast<std::ptrdiff_t>(beside.size() / 2);
    std::nth_element(beside.begin(), middle, beside.end());
    const double above = power[k] / std::max(*middle, 1e-300);
    if (above > most) {
      most = above;
      best = k;
    }
  }
  return best;
}

struct Phasor {
  double in_phase = 0.0, quadrature = 0.0;
};

// Least-squares amplitudes at this frequency; n cycles apart from the band's ends, where cos and sin are
// orthogonal.
Phasor phasor(std::span<const double> values, double cycles) {
  const std::complex<double> step = std::polar(1.0, kTurn * cycles);
  std::complex<double> turn = 1.0, sum = 0.0;
  double mean = 0.0;
  for (const double v : values) mean += v / static_cast<double>(values.size());
  for (const double v : values) {
    sum += (v - mean) * turn;
    turn *= step;
  }
  const double scale = 2.0 / static_cast<double>(values.size());
  return {scale * sum.real(), scale * sum.imag()};
}

double square(const std::vector<std::vector<double>>& axes, double cycles) {
  double sum = 0.0;
  for (const auto& axis : axes) {
    const Phasor p = phasor(axis, cycles);
    sum += p.in_phase * p.in_phase + p.quadrature * p.quadrature;
  }
  return sum / static_cast<double>(axes.size());
}

}  // namespace

TakenLine take_out_strongest_line(std::vector<std::vector<double>>& axes) {
  const auto n = static_cast<double>(axes[0].size());
  const std::vector<double> power = tapered_power(axes);
  double centre = static_cast<double>(highest(power)) / n;
  double at = square(axes, centre);
  // The main lobe is a bin wide to either side: a search by thirds inside it.
  constexpr int kHalvings = 9;  // to a thousandth of a bin
  for (int halving = 0; halving < kHalvings; ++halving) {
    const double reach = std::ldexp(0.5 / n, -halving);
    for (const double side : {-1.0, 1.0}) {
      const double other = std::clamp(centre + side * reach, 0.5 / n, 0.5 - 0.5 / n);
      const double there = square(axes, other);
      if (there > at) {
        at = there;
        centre = other;
        break;
      }
    }
  }
  for (auto& axis : axes) {
    const Phasor p = phasor(axis, centre);
    const std::complex<double> step = std::polar(1.0, kTurn * centre);
    std::complex<double> turn = 1.0;
    for (double& v : axis) {
      v -= p.in_phase * turn.real() + p.quadrature * turn.imag();
      turn *= step;
    }
  }
  return {centre, std::sqrt(at)};
}

}  // namespace ifog
