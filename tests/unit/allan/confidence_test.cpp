// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/confidence.h"
#include "filters/allan/noise/noise_coefficients.h"
#include "tests/unit/test.h"
#include "tools/simulate/noise.h"

namespace {

// The interval must hold the true deviation as often as it says, whatever the estimator, also where the noise
// changes its type at the longest τ. A short version of tests/bench/allan/coverage.cpp.
TEST(Confidence, IntervalsCoverTheTruth) {
  constexpr int kRecords = 60;
  constexpr std::size_t kSamples = 1024;
  const std::vector<std::size_t> m{1, 8, 64, 256};
  for (const ifog::simulate::NoiseLevels& levels :
       {ifog::simulate::NoiseLevels{.N = 1.0}, ifog::simulate::NoiseLevels{.K = 1.0},
        ifog::simulate::NoiseLevels{.N = 1.0, .K = 0.03}}) {
    const ifog::TermVariances truth{0.0, levels.N * levels.N, 0.0, levels.K * levels.K};
    std::array<std::vector<int>, 3> inside;
    for (int record = 0; record < kRecords; ++record) {
      const auto rate =
          ifog::simulate::noise(levels, 1.0, kSamples, 1000 + static_cast<std::uint64_t>(record));
      const std::vector<ifog::Stretch> all{{0, rate.size()}};
      const ifog::AngleSum sum(rate, all);
      const auto found = ifog::noise_coefficients(sum, 1.0);
      for (const ifog::Deviation kind :
           {ifog::Deviation::kAllan, ifog::Deviation::kModified, ifog::Deviation::kHadamard}) {
        auto& count = inside[static_cast<std::size_t>(kind)];
        count.resize(m.size());
        const auto points = ifog::deviation(sum, m, kind);
        const auto intervals = ifog::allan_intervals(sum, kind, points, found.variances, 0.683);
        for (std::size_t i = 0; i < m.size(); ++i) {
          const double deviation = std::sqrt(ifog::expected_variance(kind, truth, m[i]));
          count[i] += deviation >= intervals[i].lower_radps && deviation <= intervals[i].upper_radps;
        }
      }
    }
    // Three standard errors of 60 trials at 0.683 are 0.180. The type frozen before the end covered 20 to
    // 40 %.
    for (const auto& count : inside)
      for (std::size_t i = 0; i < m.size(); ++i)
        EXPECT_NEAR(count[i] / double{kRecords}, 0.683, 0.18)
            << "m " << m[i] << " N " << levels.N << " K " << levels.K;
  }
}

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
