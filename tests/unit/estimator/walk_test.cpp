// SPDX-License-Identifier: Apache-2.0
// What a stream says of its noise: what is white over every octave and walks, and what is motion.
#include "filters/estimator/walk.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace ifog {
namespace {

struct Heard {
  std::optional<Walk::Found> last;
  int stretches = 0;
};

// sample: the rate of a sample, given a fresh normal deviate.
Heard hear(int samples, unsigned seed, const std::function<double(int, double)>& sample, double walk = 0.0) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  Walk learner;
  Heard heard;
  double level = 0.0;
  for (int i = 0; i < samples; ++i) {
    level += std::sqrt(walk) * normal(engine);
    if (auto news = learner.take({level + sample(i, normal(engine))}, 1, true)) {
      heard.last = news;
      ++heard.stretches;
    }
  }
  return heard;
}

TEST(Walk, FindsNoiseAndWalkOfARecord) {
  for (const double ratio : {1e-4, 1e-6}) {
    const Heard heard = hear(
        400'000, 3, [](int, double noise) { return 2.0 * noise; }, 4.0 * ratio);
    ASSERT_TRUE(heard.last) << ratio;
    EXPECT_NEAR(heard.last->noise[0], 4.0, 0.3) << ratio;
    EXPECT_NEAR(std::log10(heard.last->ratio / ratio), 0.0, 0.35) << ratio;
    EXPECT_GE(heard.stretches, 90) << ratio << ": of 97";
  }
}

// A single spike is a fault of the link and not what the sensor's noise is made of.
TEST(Walk, IsNotMisledByASpike) {
  for (const int at : {20, 1000, 4000}) {
    const Heard heard = hear(4096, 9, [at](int i, double noise) { return i == at ? 400.0 : noise; });
    ASSERT_TRUE(heard.last) << at;
    EXPECT_NEAR(heard.last->noise[0], 1.0, 0.1) << at;
  }
}

// A bound that shrinks: no walk at all looks the slower the longer it is watched.
TEST(Walk, BoundsAWalkThatIsNotThere) {
  const auto white = [](int, double noise) { return noise; };
  const Heard soon = hear(20'000, 5, white), late = hear(400'000, 5, white);
  ASSERT_TRUE(soon.last && late.last);
  EXPECT_LT(soon.last->ratio, 1e-5);
  EXPECT_LT(late.last->ratio, 1e-8);
}

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
  for (std::size_t m = 0; m < motions.size(); ++m) EXPECT_EQ(hear(100'000, 7, motions[m]).stretches, 0) << m;
}

// What an earlier run knew stands until this one has had as much, and falls where the sensor is another one.
TEST(Walk, RecallsUntilItIsContradicted) {
  std::mt19937_64 engine(11);
  std::normal_distribution<double> normal;
  Walk walks[3];
  double found[3] = {}, walked = 0.0;
  walks[0].recall(1e-9, 1e6);  // the same
  walks[1].recall(1e-4, 1e6);  // the sensor is slower
  walks[2].recall(1e-9, 1e6);  // it is quicker
  for (int i = 0; i < 400'000; ++i) {
    const double rate = normal(engine);
    walked += 1e-2 * normal(engine);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto news = walks[k].take({k == 2 ? rate + walked : rate}, 1, true);
      if (news) found[k] = news->ratio;
    }
  }
  EXPECT_NEAR(found[0], 1e-9, 1e-12);
  EXPECT_LT(found[1], 1e-6);
  EXPECT_NEAR(std::log10(found[2]), -4.0, 0.5);
}

}  // namespace
}  // namespace ifog
