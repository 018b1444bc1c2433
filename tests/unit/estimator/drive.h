// SPDX-License-Identifier: Apache-2.0
// Records for the estimator's tests: a random walk in white noise with a motion on top, in units of the
// noise.
#pragma once

#include "filters/estimator/estimator.h"
#include "tests/unit/test.h"

namespace ifog::test {

inline constexpr double kPeriod = 0.01;

struct Record {
  std::vector<double> truth, measured;
};

inline Record record(std::uint64_t seed, int length, double walk_over_noise,
                     const std::function<double(int)>& motion = nullptr) {
  Noise normal(seed);
  Record made;
  double walk = 0.0;
  for (int i = 0; i < length; ++i) {
    if (i > 0) walk += std::sqrt(walk_over_noise) * normal();
    made.truth.push_back(walk + (motion ? motion(i) : 0.0));
    made.measured.push_back(made.truth.back() + normal());
  }
  return made;
}

inline FilterSettings told(double walk_over_noise, double noise = 1.0) {
  FilterSettings settings;
  settings.process_noise = walk_over_noise / kPeriod;
  settings.measurement_noise = noise;
  return settings;
}

// An estimator that is given one sample after another, a period apart and with all axes, unless `in` is changed.
struct Fed {
  explicit Fed(const FilterSettings& settings, int axes = 1, double period_s = kPeriod,
               const KnownNoise& known = {})
      : estimator(settings, axes, period_s, known) {
    in.dt_s = period_s;
    in.valid_axes = (1U << axes) - 1U;
  }
  const EstimatorOutput& step(const Axes& rates) {
    in.rate_radps = rates;
    estimator.step(in, out);
    ++in.sequence;
    return out;
  }
  Estimator estimator;
  EstimatorInput in;
  EstimatorOutput out;
};

struct Filtered {
  std::vector<double> denoised;
  std::vector<std::uint32_t> flags;
  EstimatorHealth health;
};

inline Filtered run(const FilterSettings& settings, const std::vector<double>& measured) {
  Fed filter(settings);
  Filtered result;
  for (const double rate : measured) {
    const EstimatorOutput& out = filter.step({rate});
    result.denoised.push_back(out.denoised_radps[0]);
    result.flags.push_back(out.flags);
  }
  result.health = filter.estimator.health();
  return result;
}

// A Kalman filter for a scalar random walk, told the truth, written here by hand.
inline std::vector<double> told_the_truth(const std::vector<double>& measured, double walk_over_noise) {
  std::vector<double> out{measured[0]};
  double x = measured[0], p = 1.0;
  for (std::size_t i = 1; i < measured.size(); ++i) {
    p += walk_over_noise;
    const double gain = p / (p + 1.0);
    x += gain * (measured[i] - x);
    p *= 1.0 - gain;
    out.push_back(x);
  }
  return out;
}

inline double mean_square_error(std::span<const double> estimate, const std::vector<double>& truth,
                                std::size_t from) {
  double sum = 0.0;
  for (std::size_t i = from; i < truth.size(); ++i)
    sum += (estimate[i] - truth[i]) * (estimate[i] - truth[i]);
  return sum / static_cast<double>(truth.size() - from);
}

}  // namespace ifog::test
