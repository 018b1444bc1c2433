// SPDX-License-Identifier: Apache-2.0
// The noise terms of a report, of errors whose noise the test has made.
#include "filters/diagnosis/report/noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/unit/diagnosis/blocks_by_hand.h"

namespace ifog {
namespace {

constexpr double kStep_s = 0.1;

struct Made {
  std::vector<double> time, error;
  RecordOrigin origin{};
  std::vector<Stretch> at_rest{};
};

Made white(std::uint64_t seed, std::size_t n, double deviation) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Made made;
  for (std::size_t i = 0; i < n; ++i) {
    made.time.push_back(kStep_s * static_cast<double>(i));
    made.error.push_back(deviation * normal(random));
  }
  return made;
}

Diagnosis reported(const std::vector<Made>& all, double sample_s = kStep_s, Diagnosis found = {}) {
  std::vector<Record> records;
  std::vector<EvenError> errors;
  for (const Made& made : all) {
    Record record;
    record.name = "capture " + std::to_string(records.size());
    record.time_s = made.time;
    record.rate_radps = made.error;
    record.origin = made.origin;
    record.at_rest = made.at_rest;
    EvenError error;
    error.origin = made.origin;
    error.start_s = made.time.front();
    error.after = SharedSamples(made.error);
    records.push_back(record);
    errors.push_back(error);
  }
  BlockGrid grid = grid_of({64});
  grid.sample_s = sample_s;
  KnownAngles angles;
  write_noise(records, errors, grid, {}, angles, found);
  return found;
}

TEST(Noise, IsThatOfTheSamplesAtRest) {
  Made made = white(1, 20000, 1e-6);
  for (std::size_t i = 5000; i < 10000; ++i) made.error[i] *= 20.0;
  const double n = 1e-6 * std::sqrt(kStep_s);
  const Diagnosis all = reported({made});
  ASSERT_TRUE(all.noise.N.has_value());
  EXPECT_GT(*all.noise.N, 5.0 * n);
  made.at_rest = {{0, 5000}, {10000, 20000}};
  const Diagnosis rest = reported({made});
  ASSERT_TRUE(rest.noise.N.has_value());
  EXPECT_NEAR(*rest.noise.N, n, 0.05 * n);
  EXPECT_NEAR(*rest.noise.N, n, 4.0 * rest.noise_error.N.value());
}

// Variances of terms that are as many in each capture are averaged.
TEST(Noise, OfSeveralCapturesIsThatOfAllOfThem) {
  const Diagnosis found = reported({white(2, 9000, 1e-6), white(3, 9000, 2e-6), white(4, 9000, 3e-6)});
  ASSERT_TRUE(found.noise.N.has_value());
  const double n = 1e-6 * std::sqrt(kStep_s * 14.0 / 3.0);
  EXPECT_NEAR(*found.noise.N, n, 0.05 * n);
  EXPECT_TRUE(found.noise_changes.empty());  // each is the same all along
}

TEST(Noise, WhereItChangesIsToldInTheCapturesOwnTime) {
  Made made = white(5, 20000, 1e-6);
  made.origin = {1.7e9, 0.25};
  for (std::size_t i = 8000; i < 12000; ++i) made.error[i] *= 4.0;
  const Diagnosis found = reported({white(6, 20000, 1e-6), made});
  ASSERT_EQ(found.noise_changes.size(), 1U);
  EXPECT_EQ(found.noise_changes[0].capture, "capture 1");
  const NoiseChange& change = found.noise_changes[0].change;
  EXPECT_NEAR(change.from_s, 1.7e9 + 800.25,
              64.0);  // found to a sixty-fourth of the record, twice that at most
  EXPECT_NEAR(change.to_s, 1.7e9 + 1200.25, 64.0);
  EXPECT_NEAR(change.times, 4.0, 0.4);
  ASSERT_FALSE(found.remarks.empty());
  EXPECT_TRUE(found.remarks[0].starts_with("capture 1: ")) << found.remarks[0];
}

TEST(Noise, OfTooFewSamplesIsNoneAndThatIsSaid) {
  const Diagnosis found = reported({white(7, 3, 1e-6)});
  EXPECT_FALSE(found.noise.N.has_value());
  ASSERT_EQ(found.remarks.size(), 1U);
  EXPECT_TRUE(found.remarks[0].starts_with("no noise terms: ")) << found.remarks[0];
}

// Dwells about a line of two parameters: the figure and its error are those of the draw.
TEST(Noise, OfDwellsScattersAsItsErrorSays) {
  constexpr int kDraws = 4000, kDwells = 40;
  constexpr double kDwell_s = 4.0, kDeviation = 3e-7;  // of a dwell's mean
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal(0.0, kDeviation);
  BlockGrid grid = grid_of({kDwells});
  grid.dwells = true;
  grid.block_s = kDwell_s;
  KnownAngles angles;
  double sum = 0.0, square = 0.0, said = 0.0;
  for (int draw = 0; draw < kDraws; ++draw) {
    // What is left of normal deviates by a fit of two parameters: as many fewer of them.
    double left = 0.0;
    for (int k = 0; k < kDwells - 2; ++k) left += std::pow(normal(random), 2);
    NoiseFit fit;
    fit.white_variance = left / (kDwells - 2);
    Diagnosis found;
    found.effects.resize(1);
    found.effects[0].effect.parameters.resize(1);
    write_noise({}, {}, grid, fit, angles, found);
    sum += found.noise.N.value();
    square += std::pow(found.noise.N.value(), 2);
    said += found.noise_error.N.value();
  }
  const double mean = sum / kDraws;
  EXPECT_NEAR(mean, kDeviation * std::sqrt(kDwell_s), 0.01 * mean);
  EXPECT_NEAR(said / kDraws, std::sqrt(square / kDraws - mean * mean), 0.04 * said / kDraws);
}

// A bias of 1.5e-6 rad/s that forgets in 36 s, one sample a second.
Made returning(std::uint64_t seed) {
  constexpr double kForgets_s = 36.0, kSigma = 1.5e-6;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double kept = std::exp(-1.0 / kForgets_s);
  Made made;
  double bias = kSigma * normal(random);
  for (int i = 0; i < 14400; ++i) {
    bias = kept * bias + std::sqrt(1.0 - kept * kept) * kSigma * normal(random);
    made.time.push_back(i);
    made.error.push_back(bias + 1e-6 * normal(random));
  }
  return made;
}

TEST(Noise, ABiasThatComesBackIsForetoldAsOne) {
  Diagnosis as_walk;
  as_walk.noise_posterior.parts = {{1.0, 1e-12, 1e-13, 0.0, 0.0, 0.0}};
  const Diagnosis found = reported({returning(9)}, 1.0, as_walk);
  double weights = 0.0, variance = 0.0, log_time = 0.0, white = 0.0;
  for (const NoisePosterior::Part& part : found.noise_posterior.parts) {
    weights += part.weight;
    variance += part.weight * part.markov;
    log_time += part.weight * std::log(part.markov_s);
    EXPECT_EQ(part.walk, 0.0);
    white += part.weight * part.white;
  }
  EXPECT_NEAR(weights, 1.0, 1e-9);
  EXPECT_NEAR(white, 1e-12, 0.1e-12);
  EXPECT_NEAR(std::sqrt(variance), 1.5e-6, 0.3e-6);
  EXPECT_NEAR(std::exp(log_time), 36.0, 12.0);
}

TEST(Noise, WhatTheRegressionTookForAReturnStands) {
  Diagnosis as_return;
  as_return.noise_posterior.parts = {{1.0, 1e-12, 0.0, 0.0, 2e-12, 50.0}};
  const Diagnosis found = reported({returning(10)}, 1.0, as_return);
  ASSERT_EQ(found.noise_posterior.parts.size(), 1U);
  EXPECT_EQ(found.noise_posterior.parts[0].markov_s, 50.0);
  EXPECT_TRUE(found.markov.has_value());
}

}  // namespace
}  // namespace ifog
