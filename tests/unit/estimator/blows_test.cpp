// SPDX-License-Identifier: Apache-2.0
// Hammer blows on the structure: rough at their edges, ringing on smoothly for long, and back where they
// began.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/estimator/drive.h"

namespace {

using namespace ifog::test;

// It rings, and every sample is thousands of sigmas from the one before. None of them is an outlier, and what
// is published must not overshoot them.
TEST(Blow, IsFollowed) {
  constexpr int kAt = 3000;
  const auto rings = [](int i) {
    return i < kAt ? 0.0 : 3000.0 * std::exp((kAt - i) / 60.0) * std::sin(0.7 * (i - kAt));
  };
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Record r = record(seed, kAt + 400, 1e-3, rings);
    const Filtered got = run(told(1e-3), r.measured);
    const double error = mean_square_error(got.denoised, r.truth, kAt);
    const double blow = mean_square_error(std::vector<double>(r.truth.size(), 0.0), r.truth, kAt);
    EXPECT_LT(std::sqrt(error / blow), 0.35) << seed;
  }
}

// Ten blows, a minute apart at 100 Hz: a mode that is over after a hundred samples, one that rings for a
// thousand, and one between them.
constexpr int kFirst = 20'000, kApart = 6000, kBlows = 10;
double ten_blows(int i) {
  const int blow = (i - kFirst) / kApart, k = (i - kFirst) % kApart;
  if (i < kFirst || blow >= kBlows) return 0.0;
  return (1500.0 + 100.0 * blow) * std::exp(-k / 20.0) * std::sin((0.9 + 0.02 * blow) * k) +
         150.0 * std::exp(-k / 600.0) * std::sin((0.09 + 0.005 * blow) * k) +
         20.0 * std::exp(-k / 900.0) * std::sin(0.31 * k);
}

// What users compare: means over twenty seconds, of what is published and of what was measured, each against
// the truth. At small Q/R a debt that is booked at rest would be owed for hours.
TEST(Blow, LeavesTheAngleWhereItWas) {
  constexpr std::size_t kMean = 2000;
  for (const double ratio : {1e-6, 1e-8}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const Record r = record(seed, kFirst + kBlows * kApart, ratio, ten_blows);
      const Filtered got = run(told(ratio), r.measured);
      double published = 0.0, measured = 0.0;
      for (std::size_t from = kFirst; from + kMean <= r.truth.size(); from += kMean) {
        double off = 0.0, raw = 0.0;
        for (std::size_t i = from; i < from + kMean; ++i) {
          off += got.denoised[i] - r.truth[i];
          raw += r.measured[i] - r.truth[i];
        }
        published += off * off;
        measured += raw * raw;
      }
      EXPECT_LT(std::sqrt(published / measured), 2.0) << "Q/R " << ratio << ", seed " << seed;
    }
  }
}

// A filter that was moved while its noise was loud knows its rate by that noise, and is not slow by the noise
// of before: a second after the noise is quiet again it is as near as the quiet samples alone make it.
TEST(LouderNoise, InAMotionIsWhatTheFilterAtRestIsMovedIn) {
  constexpr int kFrom = 20'000, kTurn = 600, kQuiet = kFrom + 3000;
  double square = 0.0;
  constexpr int kSeeds = 12;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Record r = record(seed, kQuiet + 1500, 1e-8, [](int i) {
      return i < kFrom || i >= kFrom + kTurn ? 0.0 : 400.0 * std::sin(3.14159265 * (i - kFrom) / kTurn);
    });
    std::mt19937_64 random(seed + 100);
    std::normal_distribution<double> normal;
    for (std::size_t i = kFrom; i < kQuiet; ++i) r.measured[i] = r.truth[i] + 30.0 * normal(random);
    const Filtered got = run(told(1e-8), r.measured);
    for (std::size_t i = kQuiet + 500; i < r.truth.size(); ++i)
      square += std::pow(got.denoised[i] - r.truth[i], 2) / 1000.0 / kSeeds;
  }
  EXPECT_LT(std::sqrt(square), 0.15);
}

}  // namespace
