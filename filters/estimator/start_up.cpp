// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/start_up.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "filters/estimator/octave_fit.h"
#include "filters/estimator/third_difference.h"

namespace ifog {
namespace {

constexpr std::size_t kLeastMeasured = 32;
// Third differences: whose median says something, of how many, and the samples that one may go over.
constexpr std::size_t kLeastThirds = 12, kShareOfThirds = 16, kMostSpan = 64;
// As in rest_noise.cpp; nearer to the best, as these seconds may have been motion.
constexpr double kNearlyAsLikely = 0.3;
// Median of the square of a standard normal.
constexpr double kMedianSquare = 0.4549364;

// Of variances, from one octave to the second after it: a walk's grow fourfold, and medians of few
// differences come no further by chance.
constexpr double kSmooth = 24.0;

struct Octave {
  double variance = 0.0;  // of the second difference of block means, mean over axes
  double count = 0.0;     // independent ones, of all axes
};

// Variance from the median square; where half of the differences are zero (coarse quantisation), from the
// mean of the lower nine tenths instead.
double robust_variance(std::vector<double>& squares) {
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  if (*middle > 0.0) return *middle / kMedianSquare;
  const auto kept = static_cast<std::ptrdiff_t>(squares.size() * 9 / 10);
  std::nth_element(squares.begin(), squares.begin() + kept, squares.end());
  double sum = 0.0;
  for (auto it = squares.begin(); it != squares.begin() + kept; ++it) sum += *it;
  return sum / static_cast<double>(kept);
}

// A block with a part missing stands on the other part; otherwise one lost sample in ten would leave no long
// block.
double present_mean(double a, double b) {
  if (!std::isfinite(a)) return b;
  return std::isfinite(b) ? 0.5 * (a + b) : a;
}

std::vector<Octave> octaves(std::span<const double> rate) {
  std::vector<Octave> all;
  std::vector<double> means(rate.begin(), rate.end());
  // Twelve differences are the fewest whose median says something.
  while (means.size() >= 14) {
    std::vector<double> squares;
    for (std::size_t i = 2; i < means.size(); ++i) {
      const double second = means[i] - 2.0 * means[i - 1] + means[i - 2];
      if (std::isfinite(second)) squares.push_back(second * second);
    }
    if (squares.size() >= 12) {
      const auto count = static_cast<double>(squares.size());
      all.push_back({robust_variance(squares), count / 2.0});
    } else {
      all.emplace_back();
    }
    std::vector<double> halved(means.size() / 2);
    for (std::size_t i = 0; i < halved.size(); ++i) halved[i] = present_mean(means[2 * i], means[2 * i + 1]);
    means = std::move(halved);
  }
  return all;
}

[[nodiscard]] bool smooth(const std::vector<Octave>& octaves) {
  for (std::size_t k = 2; k < octaves.size(); ++k)
    if (octaves[k - 2].variance > 0.0 && octaves[k].variance > kSmooth * octaves[k - 2].variance) return true;
  return false;
}

[[nodiscard]] bool constant(const std::vector<Octave>& octaves) {
  return std::none_of(octaves.begin(), octaves.end(), [](const Octave& o) { return o.variance > 0.0; });
}

// Adds an axis to what the ones before it gave: octaves that one of them lacks are dropped.
void add(std::vector<Octave>& all, const std::vector<Octave>& axis, int before) {
  if (before == 0) {
    all = axis;
    return;
  }
  all.resize(std::min(all.size(), axis.size()));
  for (std::size_t k = 0; k < all.size(); ++k) {
    all[k].variance += (axis[k].variance - all[k].variance) / (before + 1.0);
    all[k].count = axis[k].count > 0.0 && all[k].count > 0.0 ? all[k].count + axis[k].count : 0.0;
  }
}

struct Fit {
  double ratio = 0.0;  // of a walk's driving noise a sample over the white noise: the quickest that fits
  OctaveFit octaves;
};

// n: measurements, which could have shown a walk so slow.
Fit fit(const std::vector<Octave>& all, double n) {
  const double lowest = std::log(1.0 / (n * n));
  const double highest = std::log(100.0);
  constexpr int kGrid = 400;
  std::vector<double> squares, counts;
  for (const Octave& o : all) {
    squares.push_back(o.variance * o.count);
    counts.push_back(o.count);
  }
  Fit taken;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kGrid; ++i) {
    const double ratio = std::exp(lowest + (highest - lowest) * i / kGrid);
    const OctaveFit here = fit_octaves(squares, counts, ratio);
    least = std::min(least, here.misfit);
    if (here.misfit <= least + kNearlyAsLikely) taken = {ratio, here};
  }
  return taken;
}

}  // namespace

double roughness(std::span<const double> rate, std::span<const double> steps) {
  std::array<std::vector<double>, kMostSpan + 1> by_span;
  std::array<double, 4> rates{};
  std::array<double, 3> apart{};
  double since = 0.0;
  std::size_t known = 0, all = 0;
  for (std::size_t i = 0; i < rate.size(); ++i) {
    since += steps.empty() ? 1.0 : std::max(1.0, std::round(steps[i]));
    if (!std::isfinite(rate[i])) continue;
    rates = {rates[1], rates[2], rates[3], rate[i]};
    apart = {apart[1], apart[2], std::exchange(since, 0.0)};
    const double span = apart[0] + apart[1] + apart[2];
    if (++known < rates.size() || span > kMostSpan) continue;
    ++all;
    by_span[static_cast<std::size_t>(span)].push_back(third_difference_square(rates, apart));
  }
  std::vector<double> squares;
  for (const std::vector<double>& more : by_span) {
    squares.insert(squares.end(), more.begin(), more.end());
    if (squares.size() >= std::max<std::size_t>(kLeastThirds, all / kShareOfThirds))
      return robust_variance(squares);
  }
  return std::numeric_limits<double>::infinity();
}

NoiseEstimate estimate_noise(std::span<const double> rates, int axes, double dt_s) {
  const std::size_t length = rates.size() / static_cast<std::size_t>(axes);
  std::vector<Octave> all;
  Axes walk{};
  std::size_t most = 0;
  double greatest = 0.0, rough = 0.0;
  bool moved = false;
  int measured = 0, taken = 0;
  for (int axis = 0; axis < axes; ++axis) {
    const auto rate = rates.subspan(static_cast<std::size_t>(axis) * length, length);
    const auto present = static_cast<std::size_t>(
        std::count_if(rate.begin(), rate.end(), [](double r) { return std::isfinite(r); }));
    most = std::max(most, present);
    if (present < kLeastMeasured) continue;
    ++measured;
    for (const double r : rate)
      if (std::isfinite(r)) greatest = std::max(greatest, std::abs(r));
    const std::vector<Octave> own = octaves(rate);
    if (constant(own)) continue;
    moved = moved || smooth(own);
    rough += roughness(rate);
    const Fit of_axis = fit(own, static_cast<double>(present));
    walk[static_cast<std::size_t>(axis)] = of_axis.ratio * of_axis.octaves.low_noise / dt_s;
    add(all, own, taken++);
  }
  if (measured == 0) {
    throw std::invalid_argument("start-up data: " + std::to_string(most) +
                                " measurements, expected at least " + std::to_string(kLeastMeasured));
  }
  const auto n = static_cast<double>(most);
  const double last_digit = std::max(greatest * std::numeric_limits<float>::epsilon(), 1e-12);
  const double least_noise = last_digit * last_digit;
  if (taken == 0 || constant(all)) return {least_noise / (n * n * dt_s), least_noise, least_noise};
  const Fit together = fit(all, n);
  const double slow_noise = std::max(together.octaves.low_noise, least_noise);
  NoiseEstimate out{together.ratio * slow_noise / dt_s, std::max(together.octaves.noise, least_noise),
                    slow_noise};
  out.moved = moved;
  if (moved)
    out.measurement_noise = out.slow_noise = std::clamp(rough / taken, least_noise, out.measurement_noise);
  for (std::size_t a = 0; taken > 1 && a < kMaxAxes; ++a)
    if (walk[a] > 0.0) out.walk_share[a] = walk[a] / out.process_noise;
  return out;
}

}  // namespace ifog
