// SPDX-License-Identifier: Apache-2.0
// The room `residual`: what effects leave, as lines, as lines that move, and in words.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

#include "filters/diagnosis/residual/lines.h"
#include "filters/diagnosis/residual/periodogram.h"
#include "filters/diagnosis/residual/unexplained.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"

namespace ifog {
namespace {

constexpr double kPeriod = 0.01;
constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

std::vector<double> white(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values(n);
  for (double& value : values) value = normal(random);
  return values;
}

// Amplitudes of a tone by least squares scatter by sqrt(2/n) sigma; its frequency by the Cramer-Rao bound
// sqrt(6/n) sigma / (pi a T).
TEST(Lines, AToneIsFoundToItsBounds) {
  std::vector<double> error = white(20000, 1);
  const double start = 3.0;
  for (std::size_t i = 0; i < error.size(); ++i) {
    const double phase = 2.0 * M_PI * 7.3137 * (start + kPeriod * static_cast<double>(i));
    error[i] += 0.3 * std::cos(phase) + 0.4 * std::sin(phase);
  }
  const std::vector<SpectralLine> lines = find_lines(error, start, kPeriod, 0.01);
  ASSERT_EQ(lines.size(), 1U);
  const double bound = std::sqrt(6.0 / 20000.0) / (M_PI * 0.5 * 200.0);
  EXPECT_NEAR(lines[0].frequency_hz, 7.3137, 5.0 * bound);
  EXPECT_GT(lines[0].frequency_std_hz, bound);  // on the safe side of it
  EXPECT_LT(lines[0].frequency_std_hz, 2.0 * bound);
  EXPECT_NEAR(std::hypot(lines[0].cosine, lines[0].sine), 0.5, 5.0 * std::sqrt(2.0 / 20000.0));
  EXPECT_GT(lines[0].coherence, 0.95);
}

TEST(Lines, WhiteNoiseHasNoneAndItsSpectrumIsFlat) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    found += static_cast<int>(find_lines(white(4096, seed), 0.0, kPeriod, 0.01).size());
  EXPECT_LE(found, 2);  // 0.2 expected
  const Spectrum spectrum = averaged(periodogram(white(65536, 5)), kPeriod, 40);
  // One-sided: 2 sigma^2 dt. The last bands hold thousands of bins.
  EXPECT_NEAR(spectrum.density.back(), 2.0 * kPeriod, 0.05 * 2.0 * kPeriod);
}

// exp(-ratio/2) times half the samples against the significance: 2 log(0.5 n / p) is the least ratio.
TEST(RecordLines, AreProvenBesideTheEffects) {
  SearchResult found;
  const double least = 2.0 * std::log(0.5 * 10000.0 / 0.01);
  Candidate line;
  line.form = Form::kLine;
  found.chosen = {{line, least - 0.01, 1.0}, {line, least + 0.01, 1.0}};
  Lines lines;
  lines.slow = {line, line};
  lines.slow[1].frequency_hz = 0.5;
  keep_proven(found, 10000, 0.01, lines);
  ASSERT_EQ(lines.slow.size(), 1U);
  EXPECT_EQ(lines.slow[0].frequency_hz, 0.5);
}

TEST(RecordLines, AFastLineIsTakenOutOfItsRecord) {
  std::vector<EvenError> errors(2);
  errors[1].start_s = 5.0;
  for (EvenError& error : errors) {
    for (std::size_t i = 0; i < 500; ++i)
      error.rest.own().push_back(
          0.2 * std::sin(2.0 * M_PI * 12.0 * (error.start_s + kPeriod * static_cast<double>(i))));
    error.rest_held_out = error.rest;
  }
  SpectralLine line;
  line.frequency_hz = 12.0;
  line.sine = 0.2;
  take_out({{1, line}}, kPeriod, errors);
  EXPECT_LT(variance_of(errors[1].rest), 1e-20);
  EXPECT_NEAR(variance_of(errors[1].rest_held_out), 0.02, 1e-3);  // no line is corrected online
  EXPECT_NEAR(variance_of(errors[0].rest), 0.02, 1e-3);
}

Unexplained of(const std::vector<double>& left, const std::vector<SpectralLine>& peaks = {}) {
  BlockGrid grid;
  grid.block_s = 1.0;
  NoiseFit noise;
  noise.white_variance = kPeriod;  // of a mean of one second of unit noise
  return describe_unexplained(left, left, 0.0, kPeriod, noise, grid, peaks);
}

// Holes of every length and place against the minutes in which the usual energy is taken.
TEST(Unexplained, AHoleInWhiteNoiseMakesNoBursts) {
  std::uint64_t seed = 100;
  for (const std::size_t hole : {700U, 2990U, 4000U, 5003U, 5990U, 8000U})
    for (const std::size_t from : {0U, 1511U, 5000U, 14000U, 19999U - 700U}) {
      std::vector<double> holed = white(20000, ++seed);
      for (std::size_t i = from; i < std::min(from + hole, holed.size()); ++i) holed[i] = kMissing;
      EXPECT_NE(of(holed).kind, "bursts") << hole << " from " << from;
      EXPECT_NE(of(holed).kind, "changing_variance") << hole << " from " << from;
      // And a knock beside the hole stays one.
      for (std::size_t i = 10500; i < 10530; ++i) holed[i] += i % 2 ? 15.0 : -15.0;
      const bool measured = 10500 > from + hole || 10530 < from;
      EXPECT_EQ(of(holed).kind == "bursts", measured) << hole << " from " << from;
    }
}

// Of a piece with a hole few differences are left, and they scatter more than all would.
TEST(Unexplained, WhatIsLeftOfAPieceBesideAHoleIsNoBurst) {
  int bursts = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    std::vector<double> holed = white(4000, 500 + seed);
    for (std::size_t i = 0; i < holed.size(); ++i)
      if (i % 25 > 1 && (i / 25) % 2 == 1) holed[i] = kMissing;
    bursts += of(holed).kind == "bursts";
  }
  EXPECT_LE(bursts, 5);  // 1 expected
}

TEST(Unexplained, SaysWhatTheRestLooksLike) {
  const std::vector<double> noise = white(60000, 21);
  EXPECT_EQ(of(noise).kind, "nothing");

  std::vector<double> knocked = noise;
  for (const std::size_t at : {10000U, 30000U, 45000U}) {
    for (std::size_t i = at; i < at + 30; ++i) knocked[i] += i % 2 ? 15.0 : -15.0;
  }
  const Unexplained bursts = of(knocked);
  EXPECT_EQ(bursts.kind, "bursts");
  ASSERT_EQ(bursts.times_s.size(), 3U);
  EXPECT_NEAR(bursts.times_s[0], 100.0, 0.5);
  EXPECT_NEAR(bursts.times_s[2], 450.0, 0.5);

  std::vector<double> louder = noise;
  for (std::size_t i = 30000; i < 60000; ++i) louder[i] *= 3.0;
  EXPECT_EQ(of(louder).kind, "changing_variance");

  std::vector<double> drifting = noise;
  double walk = 0.0;
  const std::vector<double> steps = white(60000, 22);
  for (std::size_t i = 0; i < drifting.size(); ++i) drifting[i] += walk += 0.01 * steps[i];
  const Unexplained slow = of(drifting);
  EXPECT_EQ(slow.kind, "slow");
  EXPECT_GT(slow.fraction, 0.5);

  // By definition: the means of 1, 4, 16 … samples that scatter most beyond what neighbours differ by.
  drifting.resize(59999);
  for (std::size_t i = 20000; i < 20500; ++i) drifting[i] = std::nan("");
  double most = 0.0, share = 0.0, over_s = 0.0;
  for (std::size_t count = 1; drifting.size() / count >= 16; count *= 4) {
    std::vector<double> means;
    for (std::size_t from = 0; from + count <= drifting.size(); from += count) {
      double sum = 0.0, n = 0.0;
      for (std::size_t i = from; i < from + count; ++i)
        if (std::isfinite(drifting[i])) sum += drifting[i], n += 1.0;
      means.push_back(2.0 * n >= static_cast<double>(count) ? sum / n : std::nan(""));
    }
    double mean = 0.0, there = 0.0, square = 0.0, differences = 0.0, pairs = 0.0;
    for (const double each : means)
      if (std::isfinite(each)) mean += each, there += 1.0;
    mean /= there;
    for (std::size_t i = 0; i < means.size(); ++i) {
      if (std::isfinite(means[i])) square += (means[i] - mean) * (means[i] - mean);
      if (i == 0 || !std::isfinite(means[i]) || !std::isfinite(means[i - 1])) continue;
      differences += (means[i] - means[i - 1]) * (means[i] - means[i - 1]);
      pairs += 1.0;
    }
    const double ratio = 2.0 * square / there / (differences / pairs);
    if (pairs < 16.0 || (ratio - 1.0) * std::sqrt(pairs) <= most) continue;
    most = (ratio - 1.0) * std::sqrt(pairs);
    share = 100.0 * (1.0 - 1.0 / ratio);
    over_s = static_cast<double>(count) * kPeriod;
  }
  std::array<char, 80> words{};
  std::snprintf(words.data(), words.size(), "%.0f %% of what %.3g s means", share, over_s);
  EXPECT_NE(of(drifting).hint.find(words.data()), std::string::npos) << of(drifting).hint << words.data();

  SpectralLine peak;
  peak.frequency_hz = 3.3;
  EXPECT_EQ(of(noise, {peak}).kind, "line");
  EXPECT_EQ(of(noise, {peak}).frequency_hz, 3.3);
}

TEST(Unexplained, OfTheLongestRecordAndALoopTakesThePlace) {
  std::vector<EvenError> errors(2);
  errors[0].before = errors[0].after = white(2000, 31);
  errors[1].before = errors[1].after = white(60000, 32);
  for (std::size_t i = 30000; i < 60000; ++i) errors[1].after.own()[i] *= 3.0;
  BlockGrid grid;
  grid.block_s = 1.0;
  grid.sample_s = kPeriod;
  NoiseFit noise;
  noise.white_variance = kPeriod;
  Unexplained found = describe_rest(errors, noise, grid, 0.01);
  EXPECT_EQ(found.kind, "changing_variance");
  Hysteresis loop;
  loop.channel = "temperature_degC";
  loop.half_width = 2.0;
  loop.coefficient = M_PI / 180.0 / 3600.0;  // 1 °/h per kelvin: 4 °/h high
  describe_hysteresis(loop, found);
  EXPECT_EQ(found.kind, "hysteresis");
  EXPECT_NE(found.hint.find("4 °/h high"), std::string::npos) << found.hint;
}

}  // namespace
}  // namespace ifog
