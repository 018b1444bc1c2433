// SPDX-License-Identifier: Apache-2.0
// A bias with two states, by the telegraph that made it.
#include "filters/diagnosis/residual/two_states.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "filters/diagnosis/residual/unexplained.h"

namespace ifog {
namespace {

constexpr std::size_t kSamples = 20000;

std::vector<double> white(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values(kSamples);
  for (double& value : values) value = normal(random);
  return values;
}

TEST(TwoStates, LevelsAndStaysAreThoseOfTheTelegraph) {
  std::vector<double> error = white(1);
  // 500 steps low, 1500 high, ten times.
  for (std::size_t i = 0; i < kSamples; ++i) error[i] += i % 2000 < 500 ? 0.0 : 1.2;
  const auto found = find_two_states(error, 0.5);
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(std::abs(found->difference), 1.2, 0.08);
  EXPECT_EQ(found->jumps, 19U);
  EXPECT_NEAR(std::min(found->low_s, found->high_s), 250.0, 25.0);
  EXPECT_NEAR(std::max(found->low_s, found->high_s), 750.0, 100.0);
}

TEST(TwoStates, NoiseAWalkASwingAndOneStepHaveNone) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    std::vector<double> error = white(seed);
    EXPECT_FALSE(find_two_states(error, 0.5).has_value()) << "noise " << seed;
    const std::vector<double> drive = white(seed + 100);
    double walk = 0.0;
    for (std::size_t i = 0; i < kSamples; ++i) error[i] += walk += 0.02 * drive[i];
    EXPECT_FALSE(find_two_states(error, 0.5).has_value()) << "walk " << seed;
    error = white(seed);
    for (std::size_t i = 0; i < kSamples; ++i)
      error[i] += std::sin(2.0 * M_PI * static_cast<double>(i) / 4000.0);
    EXPECT_FALSE(find_two_states(error, 0.5).has_value()) << "swing " << seed;
    error = white(seed);
    for (std::size_t i = kSamples / 2; i < kSamples; ++i) error[i] += 2.0;
    EXPECT_FALSE(find_two_states(error, 0.5).has_value()) << "step " << seed;
  }
}

}  // namespace
}  // namespace ifog
