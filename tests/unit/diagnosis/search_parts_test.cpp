// SPDX-License-Identifier: Apache-2.0
// The parts of the search that have an answer of their own: what a channel was, how many tries there are,
// and whether slow and quick agree about an effect.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "filters/diagnosis/channels/reconstruct.h"
#include "filters/diagnosis/checks/hausman_test.h"
#include "filters/diagnosis/residual/record_lines.h"
#include "filters/diagnosis/search/effective_tries.h"
#include "filters/diagnosis/search/fit_to_readings.h"
#include "filters/diagnosis/search/search.h"

namespace ifog {
namespace {

double rms_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

BlockGrid even_grid(std::size_t n) {
  BlockGrid grid;
  grid.block_s = grid.fine_s = grid.sample_s = 1.0;
  grid.records = {{0, n}};
  grid.valid.assign(n, 1);
  for (std::size_t i = 0; i < n; ++i) grid.time_s.push_back(static_cast<double>(i));
  return grid;
}

TEST(Reconstruct, ATemperatureReadInWholeDegreesIsKnownToATenth) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::vector<double> truth, read;
  for (int i = 0; i < 8000; ++i) {
    truth.push_back(30.0 + 11.3 * std::sin(2.0 * M_PI * i / 5000.0));
    read.push_back(std::round(truth.back() + noise(random)));
  }
  const Reconstruction found = reconstruct(read);
  EXPECT_TRUE(found.smooth);
  EXPECT_GT(rms_difference(read, truth), 0.25);
  EXPECT_LT(rms_difference(found.values, truth), 0.1);
}

TEST(Reconstruct, ReadingNoiseOfASmoothChannelIsSmoothedAway) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::vector<double> truth, read;
  for (int i = 0; i < 8000; ++i) {
    truth.push_back(30.0 + 11.3 * std::sin(2.0 * M_PI * i / 5000.0));
    read.push_back(truth.back() + noise(random));
  }
  const Reconstruction found = reconstruct(read);
  EXPECT_TRUE(found.smooth);
  EXPECT_LT(rms_difference(found.values, truth), 0.0025);
}

// Two kinks in hours of straight lines, and the spline has to turn there all the same.
TEST(Reconstruct, ARampBetweenSoaksKeepsItsKinks) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::vector<double> truth, read;
  double filtered = 10.0;
  for (int i = 0; i < 22000; ++i) {
    const double target = 10.0 + 24.0 * std::clamp((i - 4000.0) / 13000.0, 0.0, 1.0);
    filtered += (target - filtered) / 200.0;
    truth.push_back(filtered);
    read.push_back(truth.back() + noise(random));
  }
  const Reconstruction found = reconstruct(read);
  EXPECT_TRUE(found.smooth);
  EXPECT_LT(rms_difference(found.values, truth), 0.003);
}

// A spline through jumps or jitter would be another channel.
TEST(Reconstruct, WhatJumpsOrJittersStaysAsItWasRead) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise;
  std::vector<double> jumps, walk;
  double level = 0.0;
  double place = 0.0;
  for (int i = 0; i < 6000; ++i) {
    if (i % 200 == 0) level = 5.0 * noise(random);
    place += 0.05 * noise(random);
    jumps.push_back(level + 0.002 * noise(random));
    walk.push_back(place + 0.002 * noise(random));
  }
  for (const std::vector<double>& channel : {jumps, walk}) {
    const Reconstruction found = reconstruct(channel);
    EXPECT_FALSE(found.smooth);
    EXPECT_EQ(found.values, channel);
    EXPECT_FALSE(stands_still(channel));
  }
}

// Every `period` steps a reading, held until the next.
std::vector<double> polled(const std::vector<double>& truth, std::size_t period) {
  std::vector<double> held;
  for (std::size_t i = 0; i < truth.size(); ++i) held.push_back(truth[i - i % period]);
  return held;
}

// Of a walk between two readings nobody knows more than the line between them (a Brownian bridge): its mean
// square there is a sixth of what it moves in a period, that of the reading before it a half.
TEST(Reconstruct, AWalkThatIsPolledIsALineBetweenItsReadings) {
  constexpr std::size_t kPeriod = 50;
  std::mt19937_64 random(6);
  std::normal_distribution<double> noise;
  std::vector<double> truth;
  double place = 0.0;
  for (int i = 0; i < 20000; ++i) truth.push_back(place += 0.05 * noise(random));
  const std::vector<double> read = polled(truth, kPeriod);
  const double moves = 0.05 * std::sqrt(static_cast<double>(kPeriod));
  EXPECT_NEAR(rms_difference(read, truth), moves * std::sqrt(1.0 / 2.0), 0.1 * moves);
  EXPECT_NEAR(rms_difference(reconstruct(read).values, truth), moves * std::sqrt(1.0 / 6.0), 0.05 * moves);
}

// A cubic spline is off by at most 5/384 h^4 times the fourth derivative (Hall and Meyer, J. Approx. Theory
// 16, 1976), 0.0006 here, and the readings by 0.004. Behind the last of them nothing is known.
TEST(Reconstruct, ASmoothChannelThatIsPolledIsASplineThroughItsReadings) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, 0.004);
  std::vector<double> truth, read;
  for (int i = 0; i < 18000; ++i) {
    truth.push_back(30.0 + 11.3 * std::sin(2.0 * M_PI * i / 5000.0));
    read.push_back(truth.back() + noise(random));
  }
  read = polled(read, 200);
  EXPECT_GT(rms_difference(read, truth), 1.0);
  Reconstruction found = reconstruct(read);
  EXPECT_TRUE(found.smooth);
  found.values.resize(17801);
  truth.resize(17801);
  EXPECT_LT(rms_difference(found.values, truth), 0.01);
}

// A hole that the record bridges with a line moves the beat.
TEST(Reconstruct, AHoleIsNoPartOfTheBeat) {
  constexpr std::size_t kPeriod = 20, kFrom = 3007, kTo = 3990;
  std::mt19937_64 random(8);
  std::normal_distribution<double> noise;
  std::vector<double> truth;
  double place = 0.0;
  for (int i = 0; i < 6000; ++i) truth.push_back(place += 0.05 * noise(random));
  std::vector<double> read = polled(truth, kPeriod);
  for (std::size_t i = kFrom; i < kTo; ++i)
    read[i] = read[kFrom - 1] + (read[kTo] - read[kFrom - 1]) * static_cast<double>(i + 1 - kFrom) /
                                    static_cast<double>(kTo + 1 - kFrom);
  const std::vector<double> found = reconstruct(read).values;
  for (std::size_t i = kFrom; i < kTo; ++i) EXPECT_NEAR(found[i], read[i], 1e-9) << i;
  for (std::size_t i = kPeriod; i < 2900; i += kPeriod) EXPECT_NEAR(found[i], truth[i], 1e-9) << i;
  for (std::size_t i = kTo + kPeriod; i < 5900; ++i) {
    if (i % kPeriod != 0) continue;
    EXPECT_NEAR(found[i], truth[i], 1e-9) << i;
  }
}

// A heater that is switched, or a current that is set, by the clock; the second current for some beats at a
// time.
TEST(Reconstruct, LevelsThatAreSetOnABeatStayAsTheyWere) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> noise;
  std::vector<double> heater, current, lasting;
  for (int i = 0; i < 6000; ++i) {
    heater.push_back(i / 100 % 5 < 2 ? 1.0 : 0.0);
    current.push_back(i % 100 == 0 ? noise(random) : current.back());
    const bool set = i == 0 || (i % 50 == 0 && random() % 3 == 0);
    lasting.push_back(set ? noise(random) : lasting.back());
  }
  for (const std::vector<double>& channel : {heater, current, lasting})
    EXPECT_EQ(reconstruct(channel).values, channel);
}

TEST(Reconstruct, ReadingNoiseAloneIsStandingStill) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> noise;
  int moving = 0;
  for (int channel = 0; channel < 50; ++channel) {
    std::vector<double> read;
    for (int i = 0; i < 5000; ++i) read.push_back(3.9 + 0.002 * noise(random));
    moving += stands_still(read) ? 0 : 1;
  }
  EXPECT_EQ(moving, 0);
}

// A derivative found on a smooth temperature, for a daemon whose thermometer reads whole degrees.
TEST(OnlineTwin, WidensTheBandwidthUntilStepsOfTheReadingDoNotShow) {
  BlockData reconstructed;
  reconstructed.grid = even_grid(4000);
  FineChannel channel;
  channel.name = "temperature_degC";
  for (int i = 0; i < 4000; ++i) channel.values.push_back(25.3 + 8.0 * std::sin(2.0 * M_PI * i / 2000.0));
  channel.varies = true;
  reconstructed.channels = {channel};
  BlockData recorded = reconstructed;
  for (double& value : recorded.channels[0].values) value = std::round(value);

  SearchResult found;
  Candidate rate;
  rate.form = Form::kRate;
  rate.channel = 0;
  rate.time_constant_s = 10.0;
  found.chosen.push_back({rate, 100.0, 1e-6});
  found.coefficients = Eigen::Vector2d(3.0, 2.0);
  found.covariance = Eigen::Matrix2d::Identity();

  SearchResult same = found;
  fit_to_readings(reconstructed, reconstructed, same);
  EXPECT_EQ(same.chosen[0].candidate.time_constant_s, 10.0);
  EXPECT_EQ(same.coefficients[1], 2.0);

  SearchResult twin = found;
  fit_to_readings(recorded, reconstructed, twin);
  const Eigen::VectorXd wanted = 2.0 * regressors(reconstructed, rate).col(0);
  const double as_found = (2.0 * regressors(recorded, rate).col(0) - wanted).norm();
  const double adapted =
      (twin.coefficients[1] * regressors(recorded, twin.chosen[0].candidate).col(0) - wanted).norm();
  EXPECT_GT(as_found, 0.7 * wanted.norm());
  EXPECT_LT(adapted, 0.5 * wanted.norm());
  EXPECT_EQ(twin.coefficients[0], 3.0);
}

// Orthogonal columns are as many tries as columns, copies of one are a single try.
TEST(Tries, AreThoseOfIndependentColumns) {
  constexpr Eigen::Index n = 256;
  Columns orthogonal = Columns::Zero(n, 64);
  for (Eigen::Index j = 0; j < 64; ++j) orthogonal(3 * j, j) = 1.0 + static_cast<double>(j);
  EXPECT_NEAR(independent_columns(orthogonal), 64.0, 20.0);
  Columns alike(n, 64);
  for (Eigen::Index i = 0; i < n; ++i) alike.row(i).setConstant(std::sin(0.1 * static_cast<double>(i)));
  EXPECT_LT(independent_columns(alike), 2.0);
}

// In white noise a step a block later is nearly the same step, in a walk it is another.
TEST(Tries, OfStepsDependOnTheNoise) {
  const BlockGrid grid = even_grid(2000);
  EXPECT_LT(independent_steps(grid, {}, 20.0), 300.0);
  EXPECT_GT(independent_steps(grid, {1e3, 0.0, 0.0, 0.0}, 20.0), 1900.0);
}

TEST(Tries, TailsAreTheTablesOfChiSquare) {
  EXPECT_NEAR(tail(3.841459, 1), 0.05, 1e-6);
  EXPECT_NEAR(tail(10.827566, 1), 0.001, 1e-8);
  EXPECT_NEAR(tail(5.991465, 2), 0.05, 1e-6);
}

struct Drawn {
  BlockGrid grid;
  Columns columns;  // measurement, constant, regressor
};

Drawn drawn(std::uint64_t seed, double coefficient_of_quick, double coefficient_of_slow) {
  constexpr std::size_t n = 1500;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise;
  Drawn d{even_grid(n), Columns(static_cast<Eigen::Index>(n), 3)};
  double walk = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i);
    walk += 0.05 * noise(random);
    const double slow = std::sin(2.0 * M_PI * t / 1500.0);
    const double quick = std::sin(2.0 * M_PI * t / 40.0);
    const auto row = static_cast<Eigen::Index>(i);
    d.columns(row, 0) = noise(random) + walk + coefficient_of_slow * slow + coefficient_of_quick * quick;
    d.columns(row, 1) = 1.0;
    d.columns(row, 2) = slow + quick;
  }
  d.grid.error = d.columns.col(0);
  return d;
}

double disagreement_of(const Drawn& d) {
  const NoiseShape shape{0.0025, 0.0, 0.0, 0.0};
  Eigen::MatrixXd covariance;
  const Eigen::VectorXd c = solve(d.grid, shape, d.columns, &covariance);
  return disagreement(d.grid, {shape, 0.0, 1.0}, d.columns, 1, c, covariance);
}

// Of an effect that is one, the two coefficients differ by chance alone: squares of unit mean.
TEST(Disagreement, HasUnitVarianceWhereThereIsNone) {
  double sum = 0.0;
  constexpr int kDraws = 100;
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    const double z = disagreement_of(drawn(seed, 2.0, 2.0));
    sum += z * z / kDraws;
  }
  EXPECT_GT(sum, 0.6);
  EXPECT_LT(sum, 1.5);
}

TEST(Disagreement, SeesAnEffectThatIsQuickOnly) {
  double least = 1e9;
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    least = std::min(least, disagreement_of(drawn(seed, 2.0, -6.0)));
  EXPECT_GT(least, 3.0);
}

// What a cycling channel leaves of its effect is periodic and no line; a line elsewhere is one.
TEST(RecordLines, HarmonicsOfAChannelAreNoLines) {
  BlockData data;
  data.grid = even_grid(4000);
  FineChannel channel;
  channel.name = "temperature_degC";
  for (int i = 0; i < 4000; ++i) channel.values.push_back(25.0 + std::sin(2.0 * M_PI * 6.5 * i / 4000.0));
  channel.varies = true;
  data.channels = {channel};
  Lines lines;
  Candidate line;
  line.form = Form::kLine;
  for (const double cycles : {19.5, 26.1, 140.0}) {
    line.frequency_hz = cycles / 4000.0;
    lines.slow.push_back(line);
  }
  leave_out_periodic(data, lines);
  ASSERT_EQ(lines.slow.size(), 1U);
  EXPECT_DOUBLE_EQ(lines.slow[0].frequency_hz, 140.0 / 4000.0);
}

}  // namespace
}  // namespace ifog
