// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/quality/noise_kinds.h"

#include <cmath>
#include <limits>

namespace ifog::bench {
namespace {

template <typename Draw>
Noise independent(std::size_t samples, Draw draw) {
  Noise noise(samples);
  for (double& value : noise) value = draw();
  return noise;
}

}  // namespace

Noise gaussian_noise(Random& random, std::size_t samples) {
  std::normal_distribution<double> normal;
  return independent(samples, [&] { return normal(random); });
}

Noise student_noise(Random& random, std::size_t samples) {
  std::student_t_distribution<double> student(3.0);
  return independent(samples, [&] { return student(random) / std::sqrt(3.0); });
}

Noise skewed_noise(Random& random, std::size_t samples) {
  std::exponential_distribution<double> exponential;
  return independent(samples, [&] { return exponential(random) - 1.0; });
}

Noise bimodal_noise(Random& random, std::size_t samples) {
  constexpr double kMode = 0.9;
  std::normal_distribution<double> about_a_mode(0.0, std::sqrt(1.0 - kMode * kMode));
  std::bernoulli_distribution upper;
  return independent(samples, [&] { return (upper(random) ? kMode : -kMode) + about_a_mode(random); });
}

Noise missing_noise(Random& random, std::size_t samples, double share) {
  Noise noise = gaussian_noise(random, samples);
  std::bernoulli_distribution missing(share);
  for (double& value : noise)
    if (missing(random)) value = std::numeric_limits<double>::quiet_NaN();
  return noise;
}

Noise outlier_noise(Random& random, std::size_t samples, double share, double size) {
  Noise noise = gaussian_noise(random, samples);
  std::bernoulli_distribution outlier(share), upwards;
  for (double& value : noise)
    if (outlier(random)) value += upwards(random) ? size : -size;
  return noise;
}

Noise changing_noise(Random& random, std::size_t samples, std::size_t from, std::size_t turn, double factor) {
  Noise noise = gaussian_noise(random, samples);
  for (std::size_t i = from; i < samples; ++i)
    if ((i - from) / turn % 2 == 0) noise[i] *= factor;
  return noise;
}

Noise coloured_noise(Random& random, std::size_t samples, double correlation) {
  Noise noise = gaussian_noise(random, samples);
  const double fresh = std::sqrt(1.0 - correlation * correlation);
  for (std::size_t i = 1; i < samples; ++i) noise[i] = correlation * noise[i - 1] + fresh * noise[i];
  return noise;
}

}  // namespace ifog::bench
