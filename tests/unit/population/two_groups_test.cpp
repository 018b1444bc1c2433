// SPDX-License-Identifier: Apache-2.0
// The two-group model against closed forms, against integration by numbers, and on drawn populations.
#include "filters/population/two_groups.h"
#include "filters/population/population.h"
#include "tests/unit/population/one_coefficient.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

double density(double x, double mean, double variance) {
  return std::exp(-0.5 * (x - mean) * (x - mean) / variance) / std::sqrt(2.0 * std::numbers::pi * variance);
}

TypePrior prior_of(double share, double mean, double spread) {
  TypePrior prior;
  prior.share = share;
  prior.mean = mean;
  prior.spread = spread;
  return prior;
}

TEST(TwoGroups, ProbabilityIsBayesTheorem) {
  const TypePrior prior = prior_of(0.3, 2.0, 0.7);
  for (const double value : {-3.0, -0.5, 0.0, 0.9, 2.5, 6.0}) {
    const Estimate estimate{value, 0.8};
    const double with = 0.3 * density(value, 2.0, 0.64 + 0.49), without = 0.7 * density(value, 0.0, 0.64);
    EXPECT_NEAR(probability(prior, estimate), with / (with + without), 1e-12);
  }
}

// The chance by adding up the density of all estimates that speak for the effect at least as much.
double chance_by_numbers(const TypePrior& prior, const Estimate& estimate) {
  const double own = estimate.std_error * estimate.std_error, all = own + prior.spread * prior.spread;
  const auto ratio = [&](double x) { return density(x, prior.mean, all) / density(x, 0.0, own); };
  const double level = ratio(estimate.value), step = 1e-4 * estimate.std_error;
  double sum = 0.0;
  for (double x = -9.0 * estimate.std_error; x < 9.0 * estimate.std_error; x += step)
    if (ratio(x) >= level) sum += density(x, 0.0, own) * step;
  return sum;
}

TEST(TwoGroups, ChanceIsWhatIntegrationGives) {
  for (const TypePrior& prior : {prior_of(0.5, 3.0, 0.5), prior_of(0.5, -1.0, 2.0), prior_of(0.5, 0.0, 1.5)})
    for (const double value : {-2.0, -0.4, 0.3, 1.1, 2.2}) {
      const Estimate estimate{value, 0.8};
      EXPECT_NEAR(chance_without(prior, estimate), chance_by_numbers(prior, estimate), 2e-4)
          << prior.mean << " " << value;
    }
}

TEST(TwoGroups, WithoutSpreadTheChanceIsOneSided) {
  const Estimate estimate{1.6448536, 1.0};
  EXPECT_NEAR(chance_without(prior_of(0.5, 4.0, 0.0), estimate), 0.05, 1e-7);
  EXPECT_NEAR(chance_without(prior_of(0.5, -4.0, 0.0), estimate), 0.95, 1e-7);
  // A little spread changes little.
  EXPECT_NEAR(chance_without(prior_of(0.5, 4.0, 1e-4), estimate), 0.05, 1e-4);
}

struct Drawn {
  std::vector<Estimate> estimates;
  std::vector<bool> has;
};

Drawn population(std::mt19937& random, std::size_t members, const TypePrior& truth) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  Drawn drawn;
  for (std::size_t i = 0; i < members; ++i) {
    const double error = 0.7 + 0.6 * uniform(random);
    drawn.has.push_back(uniform(random) < truth.share);
    const double coefficient = drawn.has.back() ? truth.mean + truth.spread * normal(random) : 0.0;
    drawn.estimates.push_back({coefficient + error * normal(random), error});
  }
  return drawn;
}

TEST(TwoGroups, ADrawnPopulationIsRecovered) {
  std::mt19937 random(11);
  const TypePrior truth = prior_of(0.7, 6.0, 1.5);
  const TypePrior found = fit_two_groups(population(random, 4000, truth).estimates);
  EXPECT_NEAR(found.share, truth.share, 0.025);
  EXPECT_NEAR(found.mean, truth.mean, 4.0 * found.mean_std_error);
  EXPECT_NEAR(found.mean_std_error, std::sqrt((1.0 + 2.25) / 2800.0), 0.004);
  EXPECT_NEAR(found.spread, truth.spread, 0.1);
}

// The expectation-maximisation's top against a plain search of the likelihood on a grid.
TEST(TwoGroups, NothingOnAGridIsLikelier) {
  std::mt19937 random(5);
  const Drawn drawn = population(random, 30, prior_of(0.6, 3.0, 1.0));
  const TypePrior found = likeliest_two_groups(drawn.estimates);
  const auto ratio = [&](double share, double mean, double spread) {
    // One member for and one against the effect are in the fit's share.
    double sum = 2.0 * (std::log(share) + std::log1p(-share));
    for (const Estimate& e : drawn.estimates) {
      const double own = e.std_error * e.std_error;
      sum +=
          2.0 * std::log(share * density(e.value, mean, own + spread * spread) / density(e.value, 0.0, own) +
                         1.0 - share);
    }
    return sum;
  };
  double best = -1e300;
  for (double share = 0.02; share < 0.99; share += 0.02)
    for (double mean = -6.0; mean < 8.0; mean += 0.1)
      for (double spread = 0.0; spread < 4.0; spread += 0.1)
        best = std::max(best, ratio(share, mean, spread));
  EXPECT_GE(ratio(found.share, found.mean, found.spread), best - 1e-3);
}

TEST(TwoGroups, TheShrunkAreNearerToTheTruth) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> truth;
  std::vector<Estimate> estimates;
  for (int i = 0; i < 200; ++i) {
    truth.push_back(6.0 + 0.5 * normal(random));
    estimates.push_back({truth.back() + normal(random), 1.0});
  }
  const TypePrior prior = fit_two_groups(estimates);
  double alone = 0.0, with = 0.0, said = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Estimate better = shrunk(without_member(estimates, i, prior), estimates[i]);
    alone += std::pow(estimates[i].value - truth[i], 2);
    with += std::pow(better.value - truth[i], 2);
    said += better.std_error * better.std_error;
  }
  // 1 / (1 / 0.25 + 1) of the variance is what normal theory leaves.
  EXPECT_NEAR(with / alone, 0.2, 0.08);
  EXPECT_NEAR(said / with, 1.0, 0.3);
}

// A type of a few gyros that are hardly spread: the likeliest spread is often zero.
TEST(TwoGroups, IntervalsOfAFewMembersHoldTheTruth) {
  std::mt19937 random(17);
  std::normal_distribution<double> normal;
  int inside = 0, inside_likeliest = 0, all = 0;
  for (int round = 0; round < 150; ++round) {
    std::vector<double> truth;
    std::vector<Estimate> estimates;
    for (int i = 0; i < 12; ++i) {
      truth.push_back(6.0 + 0.6 * normal(random));
      estimates.push_back({truth.back() + normal(random), 1.0});
    }
    const TypePrior prior = fit_two_groups(estimates), likeliest = likeliest_two_groups(estimates);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const auto holds = [&](const Estimate& e) { return std::abs(e.value - truth[i]) < 1.96 * e.std_error; };
      inside += holds(shrunk(prior, estimates[i])) ? 1 : 0;
      inside_likeliest += holds(shrunk(likeliest, estimates[i])) ? 1 : 0;
      ++all;
    }
  }
  EXPECT_GT(inside, 0.93 * all);
  EXPECT_LT(inside, 0.99 * all);
  EXPECT_LT(inside_likeliest, inside);
}

// Each gyro's own estimate, judged with the others'.
TypeEffect judged(const std::vector<Estimate>& own) {
  TypeEffect effect;
  effect.effect.parameters = {{"coefficient", 0.0, 0.0, "rad/s"}};
  for (std::size_t i = 0; i < own.size(); ++i)
    effect.gyros.emplace_back().gyro = i, effect.gyros[i].own = own[i];
  judge(effect, 0.01);
  return effect;
}

// Seven alike and one of seven times as much: it is named as standing out, and is not the type's spread.
TEST(JudgedEffect, OneFarOutIsNotTheSpreadOfTheType) {
  test::Noise noise(5, 0.4);
  const auto gyros = [&](std::size_t count, const auto& coefficient) {
    std::vector<Estimate> own;
    for (std::size_t i = 0; i < count; ++i) own.push_back({coefficient(i) + noise(), 0.4});
    return judged(own);
  };
  const TypeEffect effect = gyros(8, [](std::size_t i) { return i == 4 ? 41.0 : 6.0; });
  EXPECT_EQ(effect.set_aside, 1U);
  EXPECT_NEAR(effect.prior.mean, 6.0, 0.5);
  EXPECT_LT(effect.prior.spread, 1.0);
  EXPECT_EQ(effect.found, 8U);
  // And it is not pulled to what the others have: by less than its own error.
  EXPECT_NEAR(shrunk(effect.gyros[4].others, *effect.gyros[4].own).value, effect.gyros[4].own->value, 0.4);
  // A few that have it among many that have not are no such members.
  const TypeEffect few = gyros(12, [](std::size_t i) { return i < 3 ? 6.0 : 0.0; });
  EXPECT_EQ(few.set_aside, 0U);
  EXPECT_EQ(few.found, 3U);
}

TEST(JudgedEffect, NobodyHasWhatIsNoise) {
  std::mt19937 random(2);
  std::size_t of_type = 0;
  for (int round = 0; round < 50; ++round)
    of_type += is_of_type(fit_two_groups(population(random, 40, prior_of(1e-9, 0.0, 1.0)).estimates), 0.01);
  EXPECT_LE(of_type, 2U);  // 0.5 expected at most
}

}  // namespace
}  // namespace ifog
