// SPDX-License-Identifier: Apache-2.0
// A channel that was stuck for a while: what it did meanwhile is no step of the bias.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "filters/diagnosis/diagnose.h"
#include "tests/unit/diagnosis/gaussian_deviate.h"

namespace ifog {
namespace {

constexpr std::size_t kSamples = 6000;
constexpr std::size_t kDwell = 250;    // samples that the supply stays at a level
constexpr double kCoefficient = 1e-5;  // rad/s/V

struct Logged {
  std::vector<double> time_s, rate, supply;

  // A staircase in millivolts, and the rate that follows it.
  explicit Logged(std::uint32_t seed) {
    for (std::uint32_t i = 0; i < kSamples; ++i) {
      const double level = gaussian_deviate(i / kDwell, 1, seed, 5);
      const double volt = 12.0 + 0.2 * level + 5e-4 * gaussian_deviate(i, 2, seed, 5);
      time_s.push_back(0.5 * i);
      supply.push_back(std::round(1000.0 * volt) / 1000.0);
      rate.push_back(1e-6 * gaussian_deviate(i, 3, seed, 5) + kCoefficient * (volt - 12.0));
    }
  }
  [[nodiscard]] Record record() const {
    Record r;
    r.name = "stuck";
    r.time_s = time_s;
    r.rate_radps = rate;
    r.channels = {{"supply_V", supply}};
    return r;
  }
};

TEST(StuckChannel, MakesNoStepsOfTheLevelsItMissed) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    Logged logged(seed);
    for (std::size_t i = 2700; i < 3320; ++i) logged.supply[i] = logged.supply[2700];
    const Diagnosis found = diagnose({logged.record()}, {});
    ASSERT_EQ(found.effects.size(), 1U) << seed;
    EXPECT_EQ(found.effects[0].effect.form, "linear");
    const ModelParameter& coefficient = found.effects[0].effect.parameters.front();
    EXPECT_NEAR(coefficient.value, kCoefficient, 4.0 * coefficient.std_error) << seed;
    EXPECT_LT(coefficient.std_error, 0.02 * kCoefficient) << seed;
  }
}

}  // namespace
}  // namespace ifog
