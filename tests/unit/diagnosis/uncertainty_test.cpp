// SPDX-License-Identifier: Apache-2.0
// The promises of a fit, kept in repeated trials: how often intervals hold the truth, and how large the
// heading error of another capture is compared with its prediction.
#include "filters/diagnosis/regression/uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>

#include "filters/diagnosis/report/findings.h"
#include "filters/diagnosis/report/prediction.h"
#include "filters/diagnosis/search/search.h"
#include "tests/unit/diagnosis/made_capture.h"

namespace ifog {
namespace {

constexpr std::size_t kSamples = 600;
constexpr double kCoefficient = 0.5;
constexpr double kLag = 60.0;

double gaussian(std::uint32_t counter, std::uint32_t stream, std::uint32_t seed) {
  return gaussian_deviate(counter, stream, seed, 17);
}

// White noise of unit variance at 1 Hz, a walk that overtakes it after a minute, and a slow temperature that
// comes through with a lag.
struct Trial {
  std::vector<double> time, rate, noise, temperature;

  Trial(std::uint32_t seed, double cycles) {
    double walk = 0.0;
    double lagged = 0.0;
    for (std::uint32_t i = 0; i < kSamples; ++i) {
      walk += 0.03 * gaussian(i, 1, seed);
      time.push_back(i);
      temperature.push_back(25.0 + 10.0 * std::sin(2.0 * M_PI * cycles * i / kSamples));
      const double above = temperature.back() - 25.0;
      lagged = i == 0 ? above : lagged + (1.0 - std::exp(-1.0 / kLag)) * (above - lagged);
      noise.push_back(gaussian(i, 0, seed) + walk);
      rate.push_back(noise.back() + kCoefficient * lagged);
    }
  }

  [[nodiscard]] Record record() const {
    return made_record("trial", time, rate, {{"temperature_degC", temperature}});
  }
};

struct Fitted {
  JointFit joint;
  Diagnosis diagnosis;
};

// What the search leaves when it is right.
Fitted fitted(const Trial& trial) {
  const BlockData data = cut_to_blocks({trial.record()});
  SearchResult found;
  found.chosen.resize(1);
  Candidate& lagged = found.chosen[0].candidate;
  lagged.form = Form::kLagged;
  lagged.channel = 0;
  lagged.time_constant_s = 1.1 * kLag;
  const Columns columns = design(data, {lagged});
  found.noise = fit_noise(data.grid, columns);
  found.coefficients = solve(data.grid, found.noise.shape, columns, &found.covariance);
  Fitted fit;
  fit.joint = settle(data, found);
  Findings findings = findings_of(data, data, found, fit.joint, "");
  fit.diagnosis.effects = findings.effects;
  fit.diagnosis.covariance = covariance_of(findings.effects, fit.joint, 1, 1);
  fit.diagnosis.ranges = ranges_of(data, findings.effects);
  fit.diagnosis.noise_posterior = fit.joint.noise;
  return fit;
}

// Both promises, on the same fits.
TEST(Uncertainty, IntervalsAndThePredictedHeadingAreAsGoodAsTheySay) {
  constexpr int kTrials = 100;
  constexpr double kAligned = 60.0;
  constexpr double kAfter = 500.0;
  int coefficient = 0;
  int lag = 0;
  double square = 0.0;
  for (std::uint32_t seed = 1; seed <= kTrials; ++seed) {
    const Fitted fit = fitted(Trial(seed, 1.5));
    const std::vector<ModelParameter>& p = fit.diagnosis.effects[0].effect.parameters;
    coefficient += std::abs(p[0].value - kCoefficient) < 1.96 * p[0].std_error;
    lag += std::abs(p[1].value - kLag) < 1.96 * p[1].std_error;
    const Trial next(seed + 1000, 0.8);
    const HeadingPrediction predicted = predict_heading(fit.diagnosis, next.record(), kAligned, {kAfter});
    // The correction by a loop of our own.
    double lagged = next.temperature[0] - 25.0;
    double bias = 0.0;
    double angle = 0.0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(kAligned + kAfter); ++i) {
      if (i > 0) lagged += (1.0 - std::exp(-1.0 / p[1].value)) * (next.temperature[i] - 25.0 - lagged);
      const double left = next.rate[i] - p[0].value * lagged;
      if (static_cast<double>(i) < kAligned)
        bias += left / kAligned;
      else
        angle += left - bias;
    }
    square += angle * angle / (predicted.sigma_rad[0] * predicted.sigma_rad[0]) / kTrials;
  }
  // Binomial, 100 trials at 95 %: 95, standard deviation 2.2.
  EXPECT_GE(coefficient, 88);
  EXPECT_LE(coefficient, 99);
  EXPECT_GE(lag, 88);
  EXPECT_LE(lag, 99);
  // Mean of 100 squares of unit normals: 1, standard deviation 0.14.
  EXPECT_GT(square, 0.65);
  EXPECT_LT(square, 1.4);
}

}  // namespace
}  // namespace ifog
