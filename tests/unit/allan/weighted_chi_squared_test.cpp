// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/weighted_chi_squared.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "filters/allan/estimate_law.h"

namespace {

using ifog::WeightedChiSquared;

// Two degrees of freedom each: a sum of two exponential variables, whose distribution is closed.
TEST(WeightedChiSquared, QuantilesAreThoseOfTheHypoexponentialLaw) {
  const double a = 1.0, b = 0.3;
  const std::vector<WeightedChiSquared> parts{{a, 2.0}, {b, 2.0}};
  for (const double p : {0.025, 0.1585, 0.5, 0.8415, 0.975}) {
    const double x = ifog::quantile(parts, p);
    const double below = 1.0 - (a * std::exp(-x / (2.0 * a)) - b * std::exp(-x / (2.0 * b))) / (a - b);
    EXPECT_NEAR(below / p, 1.0, 0.02) << p;
  }
}

// Equal weights are one χ², whose quantiles are tabled (Abramowitz and Stegun, table 26.8).
TEST(WeightedChiSquared, EqualWeightsAreOneChiSquared) {
  const std::vector<WeightedChiSquared> parts(10, {2.0, 1.0});
  EXPECT_NEAR(ifog::quantile(parts, 0.95) / 2.0, 18.3070, 0.02);
  EXPECT_NEAR(ifog::quantile(parts, 0.05) / 2.0, 3.94030, 0.02);
  EXPECT_NEAR(ifog::equivalent_degrees(parts), 10.0, 1e-12);
}

// A single difference is the square of one Gaussian variable: χ² with one degree, whatever the noise.
TEST(EstimateLaw, ASingleDifferenceHasOneDegree) {
  const std::vector<std::size_t> samples{64};
  for (std::size_t term = 1; term < ifog::kTerms; ++term) {
    ifog::TermVariances noise{};
    noise[term] = 2.0;
    const double degrees = ifog::EstimateVariance(ifog::Deviation::kAllan, 32, samples).degrees(noise);
    const auto law = ifog::estimate_law(ifog::Deviation::kAllan, 32, samples, noise, degrees);
    ASSERT_EQ(law.size(), 1U);
    EXPECT_NEAR(law[0].weight, 1.0, 1e-9);
    EXPECT_NEAR(law[0].degrees, 1.0, 1e-9);
  }
}

// A trace of quantisation besides a random walk does not change how a few long averages scatter.
TEST(EstimateLaw, ATraceOfQuantisationChangesNothing) {
  const std::vector<std::size_t> samples{4096};
  const std::size_t m = 512;
  for (const double tail : {0.025, 0.975}) {
    const auto quantile_with = [&](double quantisation) {
      const ifog::TermVariances noise{quantisation, 0, 0, 1e-2};
      const double degrees = ifog::EstimateVariance(ifog::Deviation::kAllan, m, samples).degrees(noise);
      return ifog::quantile(ifog::estimate_law(ifog::Deviation::kAllan, m, samples, noise, degrees), tail);
    };
    for (const double trace : {1e-3, 0.3, 30.0})
      EXPECT_NEAR(quantile_with(trace) / quantile_with(0.0), 1.0, 0.02) << trace;
  }
}

// The law keeps the mean, and the variance that the sum over all pairs of places has, whatever the mixture.
TEST(EstimateLaw, KeepsMeanAndVariance) {
  const std::vector<std::size_t> samples{4096, 1500};
  for (const ifog::Deviation kind :
       {ifog::Deviation::kAllan, ifog::Deviation::kModified, ifog::Deviation::kHadamard})
    for (const std::size_t m : {300UL, 700UL})
      for (const ifog::TermVariances& noise :
           {ifog::TermVariances{0, 1, 0, 0}, ifog::TermVariances{0, 0, 1, 0}, ifog::TermVariances{0, 0, 0, 1},
            ifog::TermVariances{2e2, 1, 0, 1e-5}}) {
        const double degrees = ifog::EstimateVariance(kind, m, samples).degrees(noise);
        const auto law = ifog::estimate_law(kind, m, samples, noise, degrees);
        double mean = 0.0;
        for (const WeightedChiSquared& part : law) mean += part.weight * part.degrees;
        EXPECT_NEAR(mean, 1.0, 1e-3) << m;
        EXPECT_NEAR(ifog::equivalent_degrees(law) / degrees, 1.0, 0.03) << m;
      }
}

}  // namespace
