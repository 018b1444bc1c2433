// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/smoother.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "filters/estimator/estimator.h"

namespace ifog {
namespace {

// A gain of one has no walk that makes it; this one follows every sample.
constexpr double kMostGain = 0.999;
// Between where a manoeuvre is found forwards and where it is found backwards it is under way; further apart
// they are two.
constexpr std::size_t kFurthest = 100'000;

struct Pass {
  std::vector<double> gain, variance;
  std::vector<bool> moving;
};

// One direction. Of all axes: they share one gain.
Pass run(const FilterSettings& settings, std::span<const std::vector<double>> rates,
         std::span<const double> dt_s, double period_s, bool backwards) {
  const std::size_t length = dt_s.size();
  Estimator estimator(settings, static_cast<int>(rates.size()), period_s);
  EstimatorInput in;
  EstimatorOutput out;
  Pass pass{std::vector<double>(length), std::vector<double>(length), std::vector<bool>(length)};
  for (std::size_t k = 0; k < length; ++k) {
    const std::size_t i = backwards ? length - 1 - k : k;
    in.sequence = i;
    // Backwards the time to this sample is what forwards is the time to the one after it.
    in.dt_s = backwards && i + 1 < length ? dt_s[i + 1] : dt_s[i];
    in.valid_axes = 0;
    for (std::size_t a = 0; a < rates.size(); ++a) {
      if (!std::isfinite(rates[a][i])) continue;
      in.rate_radps[a] = rates[a][i];
      in.valid_axes |= 1U << a;
    }
    estimator.step(in, out);
    pass.gain[i] = std::clamp(out.gain[0], 0.0, kMostGain);
    pass.variance[i] = out.variance_rad2ps2[0];
    pass.moving[i] = (out.flags & kManoeuvre) != 0;
  }
  return pass;
}

// The walk that would settle the filter's gain at K: Q/R = K^2 / (1-K).
double walk_of(double gain, double noise) { return noise * gain * gain / (1.0 - gain); }

// Where a change was found forwards, back to where it was found backwards.
void join(const Pass& forwards, const Pass& backwards, double noise, std::vector<double>& walk) {
  for (std::size_t i = 1; i < walk.size(); ++i) {
    if (!forwards.moving[i] || forwards.moving[i - 1]) continue;
    const std::size_t least = i > kFurthest ? i - kFurthest : 0;
    std::size_t j = i;
    while (j > least && !backwards.moving[j - 1]) --j;
    if (j == least) continue;
    const double here = std::max(walk_of(forwards.gain[i], noise), walk_of(backwards.gain[j - 1], noise));
    for (std::size_t k = j; k <= i; ++k) walk[k] = std::max(walk[k], here);
  }
}

}  // namespace

Smoothed smooth_walk(std::span<const double> rate, std::span<const double> walk, double noise) {
  const std::size_t length = rate.size();
  Smoothed out{std::vector<double>(length), std::vector<double>(length)};
  std::size_t first = 0;
  while (first < length && !std::isfinite(rate[first])) ++first;
  if (first == length) {
    std::fill(out.rate_radps.begin(), out.rate_radps.end(), std::nan(""));
    std::fill(out.variance_rad2ps2.begin(), out.variance_rad2ps2.end(), std::nan(""));
    return out;
  }
  double x = rate[first], p = noise;
  out.rate_radps[first] = x;
  out.variance_rad2ps2[first] = p;
  for (std::size_t i = first + 1; i < length; ++i) {
    p += walk[i];
    if (std::isfinite(rate[i])) {
      const double gain = p / (p + noise);
      x += gain * (rate[i] - x);
      p *= 1.0 - gain;
    }
    out.rate_radps[i] = x;
    out.variance_rad2ps2[i] = p;
  }
  for (std::size_t i = length - 1; i-- > first;) {
    const double predicted = out.variance_rad2ps2[i] + walk[i + 1];
    const double share = out.variance_rad2ps2[i] / predicted;
    out.rate_radps[i] += share * (out.rate_radps[i + 1] - out.rate_radps[i]);
    out.variance_rad2ps2[i] += share * share * (out.variance_rad2ps2[i + 1] - predicted);
  }
  for (std::size_t i = first; i-- > 0;) {
    out.rate_radps[i] = out.rate_radps[first];
    out.variance_rad2ps2[i] = out.variance_rad2ps2[i + 1] + walk[i + 1];
  }
  return out;
}

std::vector<Smoothed> smooth(const FilterSettings& settings, std::span<const std::vector<double>> rates,
                             std::span<const double> dt_s, double nominal_period_s) {
  const Pass forwards = run(settings, rates, dt_s, nominal_period_s, false);
  const Pass backwards = run(settings, rates, dt_s, nominal_period_s, true);
  // R so that the filter's variance comes out: that of a settled filter is K R, its colour included.
  // The median, as the variance is larger where a change of rate was only suspected.
  std::vector<double> noises;
  for (std::size_t i = 0; i < dt_s.size(); ++i)
    if (!forwards.moving[i] && forwards.gain[i] > 0.0)
      noises.push_back(forwards.variance[i] / forwards.gain[i]);
  double noise = settings.measurement_noise;
  if (!noises.empty()) {
    const auto middle = noises.begin() + static_cast<std::ptrdiff_t>(noises.size() / 2);
    std::nth_element(noises.begin(), middle, noises.end());
    noise = *middle;
  }
  // At rest the walk is the model's: the gain of a filter that has just begun is no walk's. A model with more
  // states walks as its least gain says.
  double least = kMostGain;
  for (std::size_t i = 0; i < dt_s.size(); ++i) {
    if (!forwards.moving[i] && forwards.gain[i] > 0.0) least = std::min(least, forwards.gain[i]);
  }
  std::vector<double> walk(dt_s.size());
  for (std::size_t i = 0; i < walk.size(); ++i) {
    walk[i] = settings.state == "random-walk" ? settings.process_noise * dt_s[i] : walk_of(least, noise);
    if (forwards.moving[i]) walk[i] = std::max(walk[i], walk_of(forwards.gain[i], noise));
    if (i > 0 && backwards.moving[i - 1]) walk[i] = std::max(walk[i], walk_of(backwards.gain[i - 1], noise));
  }
  join(forwards, backwards, noise, walk);
  std::vector<Smoothed> all;
  for (const std::vector<double>& rate : rates) all.push_back(smooth_walk(rate, walk, noise));
  return all;
}

}  // namespace ifog
