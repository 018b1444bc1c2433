// SPDX-License-Identifier: Apache-2.0
// What changes and is no change of rate, and what creeps: drift, motions after rests of many kinds, blows, an axis that
// is missing.
#include "tests/unit/estimator/drive.h"
#include "tests/unit/test.h"

namespace {

using namespace ifog::test;

// A drift that takes thousands of samples to find is off by little all that time, and paying for it is no
// more than that either.
TEST(SlowDrift, ThatIsFoundPaysAsSlowlyAsItOwed) {
  constexpr int kFrom = 20'000;
  double worst = 0.0;
  std::uint64_t found = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Record r = record(60 + seed, 80'000, 1e-6, [](int i) { return 1e-4 * std::max(0, i - kFrom); });
    const Filtered got = run(told(1e-6), r.measured);
    found += got.health.manoeuvres;
    for (std::size_t i = kFrom; i < r.truth.size(); ++i)
      worst = std::max(worst, std::abs(got.denoised[i] - r.truth[i]));
  }
  EXPECT_GT(found, 0U);
  EXPECT_LT(worst, 1.3);
}

// Missing while the others' noise is learned, an axis must not be believed to be without noise for ever.
TEST(AMissingAxis, HasItsOwnNoiseWhenItComes) {
  Noise normal(27);
  Fed filter(told(1e-6), 2);
  const ifog::EstimatorOutput& out = filter.out;
  double squares = 0.0;
  for (int i = 0; i < 40'000; ++i) {
    filter.in.valid_axes = i < 1000 ? 1 : 3;
    ifog::Axes rate{normal(), i < 1000 ? std::nan("") : normal()};
    // A turn about the late axis is found, as about the other.
    if (i >= 39'000) rate[1] += 40.0;
    filter.step(rate);
    if (i >= 5000 && i < 39'000) squares += out.denoised_radps[1] * out.denoised_radps[1];
    ASSERT_GT(out.variance_rad2ps2[1], 0.0) << i;
  }
  EXPECT_LT(std::sqrt(squares / 34'000), 0.06);
  EXPECT_NEAR(out.denoised_radps[1], 40.0, 0.3);
  EXPECT_EQ(filter.estimator.health().manoeuvres, 1U);
}

TEST(Plain, IsTheRulesFilterAndNothingElse) {
  Record r = record(29, 20'000, 1e-3, [](int i) { return i > 10'000 ? 5000.0 : 0.0; });
  r.measured[5000] += 1e4;
  ifog::FilterSettings settings = told(1e-3);
  settings.plain = true;
  settings.rule = "ckf";
  const Filtered got = run(settings, r.measured);
  const std::vector<double> kalman = told_the_truth(r.measured, 1e-3);
  for (std::size_t i = 2000; i < kalman.size(); ++i)
    ASSERT_NEAR(got.denoised[i], kalman[i], 1e-9 * (1.0 + std::abs(kalman[i]))) << i;
  settings.rule = "irwe-akfg";
  EXPECT_EQ(run(settings, r.measured).health.divergences, 0U);
}

// The take-off of a drone that was handled before: one sample in ten at rest is far off. Its first two seconds at 25 Hz
// are published as they are measured, not taken for more outliers.
TEST(Changes, AMotionAfterARestFullOfOutliersIsFollowed) {
  double product = 0.0, square = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    Fed filter(told(1e-6), 1);
    double motion = 0.0;
    for (int i = 0; i < 3050; ++i) {
      double rate = normal(random);
      if (i < 2990 && random() % 10 == 0) rate += 40.0 * normal(random);
      if (i >= 3000) rate += motion = 0.5 * motion + 52.0 * normal(random);
      const double denoised = filter.step({rate}).denoised_radps[0];
      if (i >= 3000) product += denoised * rate, square += rate * rate;
    }
  }
  EXPECT_GT(product / square, 0.6);
}

// A footfall is followed from its third sample on, although it grows from each to the next, and outliers came before.
TEST(Changes, AnOnsetThatGrowsIsFollowedFromItsThirdSample) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Noise normal(seed);
    Fed filter(told(1e-6), 1);
    for (int i = 0; i < 8000; ++i) filter.step({normal() + (i % 1000 == 500 ? 60.0 : 0.0)});
    for (const double onset : {40.0, 130.0, 200.0, 390.0, 430.0, 580.0}) {
      const double rate = onset + normal(), denoised = filter.step({rate}).denoised_radps[0];
      ASSERT_LT(std::abs(denoised - rate), (onset < 200.0 ? 1.1 : 0.15) * onset)
          << onset << ", seed " << seed;
    }
  }
}

// A hand-held sensor (mpu.6500, imu-calib) that rests and is moved in turn, now and then tapped for a single sample. After
// the first motions each one is published as measured from its first sample.
TEST(Changes, OnsetsOfAHandAreFollowedFromTheFirstSample) {
  for (const int axes : {1, 3}) {
    Noise normal(9);
    Fed filter(told(1e-6), axes);
    double square = 0.0, n = 0.0;
    for (int i = 0; i < 40'000; ++i) {
      const int phase = i % 400;
      const double swing = 300.0 * std::cos(0.3 * phase) * std::exp(-0.03 * phase);
      const double motion = phase < 100 ? swing : i % 1200 == 330 ? 100.0 : 0.0, rate = motion + normal();
      filter.step({rate, 0.6 * motion + normal(), normal()});
      if (phase < 100 && i > 2000) square += std::pow(filter.out.denoised_radps[0] - rate, 2), n += 1.0;
    }
    EXPECT_LT(std::sqrt(square / n), 1.0) << axes;
  }
}

// A quadrotor whose noise was measured with its motors on takes off soon after the start. What is far quieter than the
// known noise may be coloured, but no colour explains twenty standard deviations.
TEST(Changes, ATurnIsFollowedThoughTheKnownNoiseIsTenTimesTooLarge) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Noise normal(seed);
    Fed filter(told(1e-6), 3);
    double square = 0.0;
    for (int i = 0; i < 2400; ++i) {
      const double turn = i < 400 ? 0.0 : 20.0 * std::sin(0.02 * (i - 400)), noise = 0.1 * normal();
      square += std::pow(filter.step({turn + noise, noise, -noise}).denoised_radps[0] - turn, 2);
    }
    EXPECT_LT(std::sqrt(square / 2400), 1.0) << seed;
  }
}

// A phone that was turned is put down, and shaken soon after: what the long trackers remember of the turn is no
// prediction of the shaking.
TEST(Changes, AShakeSoonAfterATurnIsNotPredictedByIt) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Noise normal(seed);
    Fed filter(told(1e-6), 1);
    for (int i = 0; i < 3350; ++i) {
      const double turn = 4000.0 * std::sin(0.02 * i) * std::min(1.0, (3000 - i) / 20.0);
      const double rate =
          normal() + (i >= 1000 && i < 3000 ? turn : 0.0) + (i >= 3150 ? 4.0 * normal() : 0.0);
      const double denoised = filter.step({rate}).denoised_radps[0];
      if (i < 3150) continue;
      ASSERT_LT(std::abs(denoised - rate), 40.0) << i << ", seed " << seed;
    }
  }
}

// A logger that receives by radio repeats its last row now and then while the hand turns the sensor. The row after it
// is no outlier.
TEST(Changes, AMotionGoesOnAfterRepeatedRows) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Noise normal(seed);
    Fed filter(told(1e-6), 3);
    ifog::Axes held{};
    for (int i = 0; i < 6000; ++i) {
      const double swing = i < 2000 ? 0.0 : 1000.0;
      if (i % 100 >= 4)
        for (std::size_t a = 0; a < 3; ++a)
          held[a] = normal() + swing * std::sin(0.1 * i + static_cast<double>(a)) * std::sin(0.013 * i);
      const ifog::Axes& denoised = filter.step(held).denoised_radps;
      if (i < 2100) continue;
      for (std::size_t a = 0; a < 3; ++a)
        ASSERT_LT(std::abs(denoised[a] - held[a]), 20.0) << i << ", " << seed;
    }
  }
}

// Hammer blows on the structure: rough at their edges, ringing on smoothly for long, and back where they
// began.

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

// A value that stays is no vibration, whatever the subtraction of it from itself leaves: a converter five times as
// coarse as the noise shows one value for long, which is no whole number of bits.
TEST(Changes, AConverterThatShowsOneValueForLongIsStillWithinItsStep) {
  constexpr double kStep = 5.0, kOffset = 0.1;
  Fed filter(told(1e-5));
  int i = 0;
  for (const double rate : record(10, 60'000, 0.0).measured) {
    const double shown = i / 1024 % 2 == 1 ? 0.0 : kStep * std::nearbyint((rate + 0.05) / kStep);
    filter.step({shown + kOffset});
    if (++i > 20'000) {
      ASSERT_LT(filter.out.variance_rad2ps2[0], kStep * kStep) << i;
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
    Noise normal(seed + 100);
    for (std::size_t i = kFrom; i < kQuiet; ++i) r.measured[i] = r.truth[i] + 30.0 * normal();
    const Filtered got = run(told(1e-8), r.measured);
    for (std::size_t i = kQuiet + 500; i < r.truth.size(); ++i)
      square += std::pow(got.denoised[i] - r.truth[i], 2) / 1000.0 / kSeeds;
  }
  EXPECT_LT(std::sqrt(square), 0.15);
}

}  // namespace
