// SPDX-License-Identifier: Apache-2.0
// What a ramp that nobody logged is looked for in: a part without a hole, and sums against its harmonics.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "filters/diagnosis/ramp/harmonic_sums.h"
#include "filters/diagnosis/ramp/unbroken_part.h"

namespace ifog {
namespace {

constexpr double kStep = 0.0078125;  // exact

// At a constant rate, with a second missing after `before` samples.
struct Turning {
  std::vector<double> time, rate, reference;

  Turning(std::size_t before, std::size_t after, double rate_radps) {
    for (std::size_t i = 0; i < before + after; ++i) {
      time.push_back(kStep * static_cast<double>(i) + (i < before ? 0.0 : 1.0));
      rate.push_back(rate_radps);
    }
  }
  [[nodiscard]] Record record() const {
    Record r;
    r.time_s = time;
    r.rate_radps = rate;
    r.reference_radps = reference;
    return r;
  }
};

TEST(UnbrokenPart, IsTheLongestWithoutAHole) {
  const Turning turning(5000, 7000, 0.25);
  const UnbrokenPart part = unbroken_part(turning.record());
  EXPECT_EQ(part.first, 5000U);
  ASSERT_EQ(part.size(), 7000U);
  EXPECT_EQ(part.sample_s, kStep);
  // Of a constant rate the angle is a straight line, and its slow part is all of it.
  for (std::size_t i = 0; i < part.size(); ++i) {
    EXPECT_NEAR(part.angle_rad[i], 0.25 * kStep * static_cast<double>(i), 1e-9);
    EXPECT_EQ(part.error_radps[i], 0.0);
  }
  EXPECT_NEAR(part.mean_turn_rad(), 0.25 * kStep, 1e-12);
}

TEST(UnbrokenPart, EndsWhereTheRateOrItsReferenceIsMissing) {
  Turning turning(12000, 0, 0.25);
  turning.rate[4999] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(unbroken_part(turning.record()).first, 5000U);
  turning.reference.assign(12000, 0.25);
  turning.reference[7000] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(unbroken_part(turning.record()).first, 0U);
  EXPECT_EQ(unbroken_part(turning.record()).size(), 4999U);
}

TEST(UnbrokenPart, OfLessThan4096SamplesThereIsNone) {
  EXPECT_EQ(unbroken_part(Turning(4095, 0, 0.25).record()).size(), 0U);
  EXPECT_EQ(unbroken_part(Turning(4096, 0, 0.25).record()).size(), 4096U);
  EXPECT_EQ(unbroken_part(Turning(4000, 4000, 0.25).record()).size(), 0U);
}

TEST(UnbrokenPart, WholeCyclesASampleAreAStroboscopesOwn) {
  const UnbrokenPart part = unbroken_part(Turning(5000, 0, 1.0).record());
  EXPECT_TRUE(part.stroboscopic(2.0 / kStep, 1));
  EXPECT_FALSE(part.stroboscopic(0.37 / kStep, 1));
  EXPECT_TRUE(part.stroboscopic(0.5 / kStep, 2));
  EXPECT_FALSE(part.stroboscopic(0.001 / kStep, 1));  // hardly turned is no whole cycle
}

// A sensor whose angle is wrong by `size` times the cosine of a harmonic of the angle; turned unevenly.
struct Wrong {
  UnbrokenPart part;
  double square = 0.0;

  Wrong(double cycles_per_rad, std::size_t harmonic, double size) {
    part.sample_s = kStep;
    for (std::size_t i = 0; i < 20000; ++i) {
      const double t = kStep * static_cast<double>(i);
      part.angle_rad.push_back(1e-3 * t + 1e-4 * std::sin(0.3 * t));
      part.error_radps.push_back(0.0);
      if (i == 0) continue;
      const auto wrong = [&](double angle) {
        return size *
               std::cos(2.0 * std::numbers::pi * static_cast<double>(harmonic) * cycles_per_rad * angle +
                        0.7);
      };
      part.error_radps[i] = (wrong(part.angle_rad[i]) - wrong(part.angle_rad[i - 1])) / kStep;
      square += part.error_radps[i] * part.error_radps[i];
    }
  }
};

TEST(HarmonicSums, FindTheEnergyOfTheHarmonicThatIsThere) {
  constexpr double kCycles = 2000.0;  // some 300 in all
  const Wrong wrong(kCycles, 2, 1e-8);
  const HarmonicSums sums(wrong.part, wrong.part.angle_rad, kCycles, 3);
  ASSERT_EQ(sums.harmonics(), 3U);
  EXPECT_EQ(sums.samples(), 20000U);
  EXPECT_NEAR(sums.square(), wrong.square, 1e-9 * wrong.square);
  EXPECT_NEAR(sums.explained(2, kCycles), wrong.square, 0.01 * wrong.square);
  EXPECT_LT(sums.explained(1, kCycles), 0.01 * wrong.square);
  EXPECT_LT(sums.explained(3, kCycles), 0.01 * wrong.square);
  // Off by so much that the last piece is two cycles beside the first, nothing is left of it.
  EXPECT_LT(sums.explained(2, kCycles + 1.0 / wrong.part.angle_rad.back()), 0.05 * wrong.square);
}

TEST(HarmonicSums, AnotherFrequencyNearbyIsAsGoodAsSummedForIt) {
  const Wrong wrong(2000.0, 1, 1e-8);
  const HarmonicSums beside(wrong.part, wrong.part.angle_rad, 2003.0, 1);
  EXPECT_NEAR(beside.explained(1, 2000.0), wrong.square, 0.01 * wrong.square);
}

TEST(HarmonicSums, AnglesThatAreCountedStandStill) {
  UnbrokenPart counted;
  counted.sample_s = kStep;
  for (std::size_t i = 0; i < 5000; ++i) {
    counted.angle_rad.push_back(0.25 * static_cast<double>(i % 7));  // multiples of a pulse
    counted.error_radps.push_back(0.0);
  }
  EXPECT_NEAR(HarmonicSums(counted, counted.angle_rad, 4.0, 1).standing(1), 1.0, 1e-3);
  const Wrong turning(2000.0, 1, 1e-8);
  EXPECT_LT(HarmonicSums(turning.part, turning.part.angle_rad, 2000.0, 1).standing(1), 0.05);
}

}  // namespace
}  // namespace ifog
