// SPDX-License-Identifier: Apache-2.0
// A bias that is periodic in temperature is reported as such, whatever its period, and not approximated by
// polynomials, which diverge outside the range.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "filters/diagnosis/diagnose.h"
#include "tests/unit/diagnosis/findings.h"
#include "tests/unit/diagnosis/made_capture.h"

namespace ifog {
namespace {

constexpr std::size_t kSamples = 6000;

// A chamber that goes up and down twice between 10 and 30 degC; a white rate and one that walks.
struct Chamber {
  std::vector<double> time, rate, temperature, supply;

  explicit Chamber(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    double walk = 0.0;
    for (std::size_t i = 0; i < kSamples; ++i) {
      const double t = static_cast<double>(i);
      time.push_back(t);
      temperature.push_back(20.0 + 8.5 * std::sin(2.0 * M_PI * t / 3100.0) +
                            1.5 * std::sin(2.0 * M_PI * t / 410.0) + 0.02 * normal(random));
      supply.push_back(12.0 + 0.05 * std::sin(2.0 * M_PI * t / 700.0) + 0.002 * normal(random));
      walk += 2e-9 * normal(random);
      rate.push_back(1e-6 * normal(random) + walk);
    }
  }
  [[nodiscard]] Diagnosis diagnosed() const {
    return diagnose(
        {made_record("chamber", time, rate, {{"temperature_degC", temperature}, {"supply_V", supply}})}, {});
  }
};

TEST(Fringes, AreToldWithTheirPeriodAndPhase) {
  for (const double period : {2.0, 5.3, 13.0}) {
    Chamber chamber(3);
    for (std::size_t i = 0; i < kSamples; ++i)
      chamber.rate[i] += 4e-7 * std::cos(2.0 * M_PI * chamber.temperature[i] / period - 0.9);
    const Diagnosis found = chamber.diagnosed();
    EXPECT_EQ(found.effects.size(), 2U) << period;
    // What the model says of each temperature between 10 and 30 degC, against the law: the largest difference
    // but for a constant.
    double least = 1.0, most = -1.0;
    for (double degC = 10.0; degC <= 30.0; degC += 0.05) {
      double told = -4e-7 * std::cos(2.0 * M_PI * degC / period - 0.9);
      for (const FoundEffect& each : found.effects) {
        const double turns = (degC - each.effect.reference) / each.effect.period;
        EXPECT_NEAR(each.effect.period, period, 0.02 * period);
        const double phase = each.effect.form == "sine" ? 0.25 : 0.0;
        told += each.effect.parameters.front().value * std::cos(2.0 * M_PI * (turns - phase));
      }
      least = std::min(least, told);
      most = std::max(most, told);
    }
    EXPECT_LT(most - least, 0.25 * 4e-7) << period;
    EXPECT_NE(found.effects[0].effect.meaning.find("fringe"), std::string::npos);
  }
}

TEST(Fringes, AreNotMadeOfNoise) {
  for (std::uint64_t seed = 20; seed < 32; ++seed) {
    const Diagnosis found = Chamber(seed).diagnosed();
    EXPECT_EQ(effect_of(found, "cosine"), nullptr) << seed;
    EXPECT_EQ(effect_of(found, "sine"), nullptr) << seed;
  }
}

}  // namespace
}  // namespace ifog
