// SPDX-License-Identifier: Apache-2.0
// Noise that is not white, as every measured record's: lines, a colour, tails. The test for manoeuvres must
// not find any in it, and must still find a real one.
#include "filters/estimator/walk.h"
#include "tests/unit/capture/read_capture.h"
#include "tests/unit/estimator/drive.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

using namespace test;

struct Colour {
  const char* name;
  double correlation;  // of neighbouring samples
  double line;         // amplitude of a line of 48 samples, in sigma of the noise
  double tails;        // share of samples with four times the noise
};

void PrintTo(const Colour& c, std::ostream* out) { *out << c.name; }

std::vector<double> coloured(const Colour& c, std::uint64_t seed, int length) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const double phase = 2 * std::numbers::pi * uniform(random);
  std::vector<double> made;
  double noise = normal(random);
  for (int i = 0; i < length; ++i) {
    noise = c.correlation * noise + std::sqrt(1 - c.correlation * c.correlation) * normal(random);
    const double wide = uniform(random) < c.tails ? 4.0 * normal(random) : 0.0;
    made.push_back(noise + wide + c.line * std::sin(2 * std::numbers::pi * i / 48.0 + phase));
  }
  return made;
}

double spread(const std::vector<double>& values, std::size_t from) {
  return std::sqrt(mean_square_error(values, std::vector<double>(values.size(), 0.0), from));
}

std::ptrdiff_t moving(const Filtered& got, std::size_t from, std::size_t until) {
  return std::ranges::count_if(std::span(got.flags).first(until).subspan(from),
                               [](std::uint32_t each) { return (each & kManoeuvre) != 0; });
}

class ColouredNoise : public testing::TestWithParam<Colour> {};

TEST_P(ColouredNoise, IsNotTakenForManoeuvres) {
  constexpr int kLength = 100'000;
  constexpr std::size_t kLearned = 10'000;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const std::vector<double> measured = coloured(GetParam(), seed, kLength);
    FilterSettings settings = told(1e-6);
    const Filtered followed = run(settings, measured);
    settings.follow_manoeuvres = false;
    const Filtered plain = run(settings, measured);
    EXPECT_EQ(moving(followed, kLearned, kLength), 0) << "seed " << seed;
    EXPECT_LT(spread(followed.denoised, kLearned), 1.15 * spread(plain.denoised, kLearned))
        << "seed " << seed;
  }
}

TEST_P(ColouredNoise, DoesNotHideAChangeOfRate) {
  constexpr int kAt = 30'000;
  std::vector<double> measured = coloured(GetParam(), 7, kAt + 200);
  for (std::size_t i = kAt; i < measured.size(); ++i) measured[i] += 40.0;
  const Filtered got = run(told(1e-6), measured);
  EXPECT_EQ(got.health.manoeuvres, 1U);
  for (std::size_t i = kAt + 20; i < measured.size(); ++i) ASSERT_NEAR(got.denoised[i], 40.0, 6.0) << i - kAt;
}

// Nor where a motion has made them follow: it ends, and the noise is no motion by being foreseen.
TEST(StronglyColouredNoise, IsNotFollowedOnceAMotionIsOver) {
  constexpr int kFrom = 40'000, kUntil = 44'000, kLength = 100'000;
  for (const double correlation : {0.8, 0.9, 0.95}) {
    std::ptrdiff_t follows = 0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      std::vector<double> measured = coloured({"", correlation, 0.0, 0.0}, 10 + seed, kLength);
      for (std::size_t i = kFrom; i < kUntil; ++i)
        measured[i] += 30.0 * std::sin(2 * std::numbers::pi * static_cast<double>(i - kFrom) / 2000.0);
      const Filtered got = run(told(1e-3), measured);
      EXPECT_GE(got.health.manoeuvres, 1U);
      follows += moving(got, kUntil, kLength);
    }
    EXPECT_LT(follows, 4 * (kLength - kUntil) / 5) << "correlation " << correlation;
  }
}

// Nor where it begins like a motion, as it does once in a hundred and fifty records: what goes about a mean,
// no louder than the noise that was told, is that noise.
TEST(StronglyColouredNoise, ThatBeginsLikeAMotionIsNotFollowedForEver) {
  for (const auto& [correlation, seeds] : {std::pair{0.9, 40U}, {0.98, 180U}}) {
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      const std::vector<double> measured = coloured({"", correlation, 0.0, 0.0}, seed, 8000);
      EXPECT_EQ(run(told(1e-6), measured).flags.back() & kManoeuvre, 0U)
          << "correlation " << correlation << ", seed " << seed;
    }
  }
}

// A plate that rocks by some standard deviations, growing out of the noise, and a gyro that is turned by hand; R is as
// `ifog compare` finds it. What is published is hardly farther from what was measured than that.
TEST(SmallMotion, OfARealSensorIsNoColour) {
  for (const auto& [name, noise, most] :
       {std::tuple{"sub_tilt_y", 8.8e-13, 1.1}, {"kvh1750_direct_imu_rate", 1.7e-8, 3.0}}) {
    const std::string path = std::string(IFOG_SHARED_DATA) + "/" + name + ".csv.gz";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there, beside the project";
    const std::vector<double> measured = read_capture(path).rate_radps[0];
    const Filtered got = run(told(1e-3 * noise, noise), measured);
    EXPECT_LT(std::sqrt(mean_square_error(got.denoised, measured, 0) / noise), most) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, ColouredNoise,
                         testing::Values(Colour{"correlated", 0.5, 0.0, 0.0}, Colour{"line", 0.0, 0.8, 0.0},
                                         Colour{"tails", 0.0, 0.0, 0.02}, Colour{"all", 0.3, 0.5, 0.01}));

// What a stream says of its noise: what is white over every octave and walks, and what is motion.

TEST(Walk, TakesNoMotionForNoise) {
  constexpr double kRadian = 2.0 * 3.14159265358979;
  double slow = 0.0, before = 0.0;
  const std::vector<std::function<double(int, double)>> motions{
      // Shaking whose angle is bounded: the difference of a bounded angle.
      [&](int, double noise) { return 10.0 * (noise - std::exchange(before, noise)); },
      // The same of a corner at a fiftieth of the sample rate.
      [&](int, double noise) {
        slow += 0.126 * (noise - slow);
        return 40.0 * (noise - slow);
      },
      [](int i, double noise) { return noise + 10.0 * std::sin(kRadian * 0.01 * i); },
      [](int i, double noise) { return noise + 0.01 * (i % 4000); }};
  for (std::size_t m = 0; m < motions.size(); ++m) {
    test::Noise normal(7);
    Walk learner;
    for (int i = 0; i < 100'000; ++i)
      ASSERT_FALSE(learner.take({motions[m](i, normal())}, 1)) << m << ", sample " << i;
  }
}

// What an earlier run knew stands until this one has had as much, and falls where the sensor is another one.
TEST(Walk, RecallsUntilItIsContradicted) {
  test::Noise normal(11);
  Walk walks[3];
  double found[3] = {}, walked = 0.0;
  walks[0].recall(1e-9, 1e6);  // the same
  walks[1].recall(1e-4, 1e6);  // the sensor is slower
  walks[2].recall(1e-9, 1e6);  // it is quicker
  for (int i = 0; i < 400'000; ++i) {
    const double rate = normal();
    walked += 1e-2 * normal();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto news = walks[k].take({k == 2 ? rate + walked : rate}, 1);
      if (news) found[k] = news->ratio;
    }
  }
  EXPECT_NEAR(found[0], 1e-9, 1e-12);
  EXPECT_LT(found[1], 1e-6);
  EXPECT_NEAR(std::log10(found[2]), -4.0, 0.5);
}

}  // namespace
}  // namespace ifog
