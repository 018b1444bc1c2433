// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/regression/noise_fit.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>

#include "drivers/row_times/median.h"
#include "filters/diagnosis/regression/design.h"
#include "filters/linear/fourier.h"
#include "filters/linear/least_squares.h"

namespace ifog {
namespace {

constexpr double kLeastPeriods = 64.0;  // in the longest record
constexpr double kLeastDecay = 1.0;
constexpr double kMostDecays = 16.0;  // fewest decay times in a record
constexpr std::size_t kFewestBlocks = 512;
constexpr std::size_t kMostOrders = 6;
constexpr double kSmallWalk = 1e-5, kSmallFlicker = 1e-3;
constexpr double kRoughStep = 1.4;
constexpr double kFine = 1.05;

// Spectrum of the innovations / that of white noise of the same power; bins 0 … length / 2. Empty if an
// innovation is not finite.
struct WhiteSpectrum {
  std::vector<double> power;
  double ordinates = 1.0;  // independent ones per bin
  [[nodiscard]] double cycles(double bin) const { return 0.5 * bin / static_cast<double>(power.size() - 1); }
};

WhiteSpectrum of_innovations(const BlockGrid& grid, const Columns& columns, const NoiseShape& shape) {
  Columns white = columns;
  Whitening(grid, shape).apply(white);
  const Eigen::VectorXd left = left_by(white.rightCols(white.cols() - 1), white.col(0));
  if (!std::isfinite(left.squaredNorm())) return {};
  const std::size_t length = std::bit_ceil(grid.longest());
  WhiteSpectrum found{std::vector<double>(length / 2 + 1, 0.0),
                      static_cast<double>(grid.used()) / static_cast<double>(length)};
  for (const BlockRange& record : grid.records) {
    std::vector<double> values(length, 0.0);
    for (std::size_t b = record.first; b < record.end; ++b)
      if (grid.valid[b]) values[b - record.first] = left[static_cast<Eigen::Index>(b)];
    const std::vector<double> power = power_spectrum(values);
    for (std::size_t k = 0; k < power.size(); ++k) found.power[k] += power[k];
  }
  const double square = std::max(left.squaredNorm(), 1e-300);
  for (double& power : found.power) power /= square;
  return found;
}

struct Hump {
  double cycles = 0.0, width = 0.0;  // per block
  double ratio = 0.0;                // over the floor
  double floor = 1.0;                // level of the innovations outside humps
  double gain = 0.0;                 // gain of twice the log-likelihood by another white level in the hump
};

// Median of short stretches of the spectrum.
double floor_of(const WhiteSpectrum& spectrum, std::size_t first) {
  constexpr std::size_t kBins = 16;
  std::vector<double> means;
  for (std::size_t k = first; k + kBins <= spectrum.power.size(); k += kBins) {
    double sum = 0.0;
    for (std::size_t i = k; i < k + kBins; ++i) sum += spectrum.power[i];
    means.push_back(sum / kBins);
  }
  return std::max(median(means), 1e-6);
}

// Stretch of the spectrum with the most significant excess over the floor (Whittle's likelihood).
std::optional<Hump> highest_hump(const WhiteSpectrum& spectrum, const HarmonicLimits& limits) {
  const std::size_t n = spectrum.power.size();
  if (n < 2) return std::nullopt;
  const auto first = static_cast<std::size_t>(std::ceil(limits.least_cycles / spectrum.cycles(1.0)));
  if (first + 64 > n) return std::nullopt;
  std::vector<double> sum(n + 1, 0.0);
  for (std::size_t k = 0; k < n; ++k) sum[k + 1] = sum[k] + spectrum.power[k];
  const double floor = floor_of(spectrum, first);
  std::optional<Hump> best;
  for (std::size_t width = 4; width <= n / 6; width *= 2) {
    for (std::size_t k = first; k + width <= n; k += width / 4) {
      const auto bins = static_cast<double>(width);
      const double ratio = (sum[k + width] - sum[k]) / bins / floor;
      if (!(ratio > 1.0)) continue;
      const double gain = 2.0 * bins * spectrum.ordinates * (ratio - 1.0 - std::log(ratio));
      if (best && gain <= best->gain) continue;
      const double middle = static_cast<double>(k) + 0.5 * (bins - 1.0);
      best = Hump{spectrum.cycles(middle), spectrum.cycles(bins), ratio, floor, gain};
    }
  }
  return best;
}

// The previous white noise included the hump; all is now relative to the floor.
NoiseShape with_hump(const BlockGrid& grid, const NoiseShape& shape, const Hump& hump, double white,
                     DampedHarmonic::Of of) {
  const HarmonicLimits limits = harmonic_limits(grid);
  const double density = relative_density(grid, shape, hump.cycles);
  NoiseShape with = shape;
  // Components hidden by too large a white noise may be present.
  with.walk = std::max(shape.walk / white, kSmallWalk);
  with.flicker = std::max(shape.flicker / white, kSmallFlicker);
  for (DampedHarmonic& each : with.harmonics) each.variance /= white;
  const double decay =
      std::clamp(1.0 / (std::numbers::pi * hump.width), limits.least_decay, limits.most_decay);
  // Area on both sides of zero: height times half pi times the width.
  DampedHarmonic mine{0.0, hump.cycles, decay, of};
  mine.variance = std::numbers::pi * hump.width * (hump.ratio - 1.0) * hump.floor * density / white /
                  mine.seen_at(hump.cycles);
  with.harmonics.push_back(mine);
  return with;
}

NoiseFit add_one(const BlockGrid& grid, const Columns& columns, const NoiseFit& fit, const Hump& hump) {
  NoiseFit likelier{{}, -1e300, 0.0};
  for (const auto of : {DampedHarmonic::Of::kAngle, DampedHarmonic::Of::kRate}) {
    NoiseFit best{{}, -1e300, 0.0};
    for (const double white : {1.0, std::sqrt(hump.floor), hump.floor}) {
      for (const double wider : {1.0, 4.0}) {
        NoiseShape start = with_hump(grid, fit.shape, hump, white, of);
        DampedHarmonic& mine = start.harmonics.back();
        mine.decay = std::max(mine.decay / wider, kLeastDecay);
        const double value = fit_whitened(grid, start, columns).log_likelihood();
        if (value > best.log_likelihood) best = {start, value, 0.0};
      }
    }
    best = climb(grid, columns, best.shape, kRoughStep, true);
    if (best.log_likelihood > likelier.log_likelihood) likelier = best;
  }
  return likelier;
}

// Bayesian information criterion: twice the log-likelihood that a harmonic has to gain.
double cost_of_one(const BlockGrid& grid) {
  constexpr double kParameters = 3.0;
  return kParameters * std::log(static_cast<double>(grid.used()));
}

}  // namespace

HarmonicLimits harmonic_limits(const BlockGrid& grid) {
  const auto longest = static_cast<double>(grid.longest());
  return {kLeastPeriods / longest, kLeastDecay, longest / kMostDecays};
}

NoiseFit with_harmonics(const BlockGrid& grid, const Columns& columns, const NoiseFit& fit) {
  if (grid.dwells || grid.longest() < kFewestBlocks) return fit;
  const HarmonicLimits limits = harmonic_limits(grid);
  NoiseFit best = fit;
  while (best.shape.harmonics.size() < kMostOrders) {
    const std::optional<Hump> hump = highest_hump(of_innovations(grid, columns, best.shape), limits);
    if (!hump || hump->gain < cost_of_one(grid)) break;
    const NoiseFit more = add_one(grid, columns, best, *hump);
    if (2.0 * (more.log_likelihood - best.log_likelihood) < cost_of_one(grid)) break;
    best = more;
  }
  return best.shape.harmonics.empty() ? fit : climb(grid, columns, best.shape, kFine, true);
}

}  // namespace ifog
