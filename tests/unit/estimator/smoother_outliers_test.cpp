// SPDX-License-Identifier: Apache-2.0
// Outliers in a recording: none of them is in what is smoothed.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "tests/unit/estimator/drive.h"
#include "tests/unit/estimator/smooth_one.h"

namespace {

using namespace ifog::test;

// One sample in two hundred, each to the same side; never two together.
bool struck(std::size_t i) { return i % 200 == 77; }

TEST(SmoothedOutliers, AreNotInItAtRest) {
  constexpr std::size_t kLength = 60'000;
  constexpr double kRatio = 1e-8;
  for (const double height : {30.0, 50.0, 300.0}) {
    double struck_square = 0.0, clean_square = 0.0, causal_square = 0.0;
    for (std::uint64_t seed = 61; seed < 64; ++seed) {
      Record r = record(seed, kLength, kRatio);
      clean_square += mean_square_error(smooth_one(told(kRatio), r.measured).rate_radps, r.truth, 0);
      for (std::size_t i = 0; i < kLength; ++i)
        if (struck(i)) r.measured[i] += height;
      struck_square += mean_square_error(smooth_one(told(kRatio), r.measured).rate_radps, r.truth, 0);
      causal_square += mean_square_error(run(told(kRatio), r.measured).denoised, r.truth, 0);
    }
    EXPECT_LT(struck_square, 1.3 * clean_square) << height;
    EXPECT_LT(struck_square, causal_square) << height;
  }
}

// In motion the shortest parabola that averages predicts to 2 sigma, and both directions have to reject an outlier.
// None of those of 20 sigma stay in, some of those of 15 do.
TEST(SmoothedOutliers, AreNotInItInMotion) {
  constexpr std::size_t kLength = 40'000;
  constexpr double kRatio = 1e-8;
  for (const double height : {20.0, 30.0, 50.0, 300.0}) {
    Record r = record(65, kLength, kRatio, [](int i) { return 1280.0 * std::sin(0.003 * i); });
    for (std::size_t i = 0; i < kLength; ++i)
      if (struck(i)) r.measured[i] += height;
    const ifog::Smoothed got = smooth_one(told(kRatio), r.measured);
    double square = 0.0, normalised = 0.0;
    int count = 0;
    for (std::size_t i = 1000; i < kLength; ++i) {
      if (!struck(i)) continue;
      const double apart = got.rate_radps[i] - r.truth[i];
      square += apart * apart;
      normalised += apart * apart / got.variance_rad2ps2[i];
      ++count;
    }
    EXPECT_LT(std::sqrt(square / count), 0.5) << height;
    EXPECT_LT(normalised / count, 2.0) << height;
    EXPECT_LT(mean_square_error(got.rate_radps, r.truth, 1000), 0.1) << height;
  }
}

}  // namespace
