// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "drivers/row_times/median.h"
#include "filters/allan/noise/noise_spectrum.h"
#include "filters/distributions/chi_squared.h"

namespace ifog {
namespace {

constexpr std::size_t kBeside = 2;   // bins on either side into which the window smears a line
constexpr std::size_t kNearby = 12;  // bins on either side that give the usual level
constexpr std::size_t kFewest = 4;   // usable ones of these
constexpr double kChance = 1e-6;
constexpr double kMargin = 1.1;  // allows for the curvature of a smooth spectrum

// Expected logarithm of the density: mean of the medians on both sides, which follows a slope.
double usual(const std::vector<double>& level, std::size_t i) {
  std::vector<double> left, right;
  for (std::size_t j = kBeside + 1; j <= kNearby; ++j) {
    if (i >= j) left.push_back(level[i - j]);
    if (i + j < level.size()) right.push_back(level[i + j]);
  }
  if (left.size() < kFewest) return right.empty() ? level[i] : median(right);
  if (right.size() < kFewest) return median(left);
  return 0.5 * (median(left) + median(right));
}

}  // namespace

void leave_out_lines(NoiseSpectrum& spectrum) {
  std::vector<SpectralBin>& bins = spectrum.bins;
  std::vector<double> level;  // logarithm of density / white noise
  level.reserve(bins.size());
  for (const SpectralBin& bin : bins)
    level.push_back(std::log(std::max(1e-300, bin.power / bin.expected[kN])));
  std::map<double, double> limits;  // by degrees of freedom
  for (std::size_t i = 0; i < bins.size(); ++i) {
    double& limit = limits[bins[i].degrees];
    if (limit == 0.0)
      limit = std::log(kMargin * chi_squared_quantile(1.0 - kChance, bins[i].degrees) / bins[i].degrees);
    if (level[i] - usual(level, i) <= limit) continue;
    const std::size_t low = i - std::min(i, kBeside), high = std::min(bins.size() - 1, i + kBeside);
    for (std::size_t j = low; j <= high; ++j) bins[j].used = false;
    const FrequencyRange line{bins[low].frequency, bins[high].frequency};
    if (!spectrum.lines.empty() && spectrum.lines.back().high >= line.low)
      spectrum.lines.back().high = line.high;
    else
      spectrum.lines.push_back(line);
  }
}

}  // namespace ifog
