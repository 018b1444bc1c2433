// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/noise/gauss_markov.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "filters/allan/noise/angle_means.h"
#include "filters/allan/noise/noise_coefficients.h"
#include "tools/simulate/noise.h"

namespace {

// IEEE Std 952, annex C: exponentially correlated noise of drive q and time T.
TEST(GaussMarkov, ItsAllanVarianceIsTheStandardsIntegral) {
  const double correlation = 300.0;
  for (const double m : {0.1, 1.0, 30.0, 300.0, 567.0, 3000.0, 1e5}) {
    // Of the spectrum q²/(ω² + 1/T²), one-sided, against 2 sin⁴(πfm)/(πfm)².
    double sum = 0.0;
    const double step = 2e-4;
    for (double log_f = std::log(1e-9); log_f < std::log(40.0 / m + 1.0); log_f += step) {
      const double f = std::exp(log_f), turn = 2.0 * std::numbers::pi * f, x = std::numbers::pi * f * m;
      sum += step * f * 2.0 / (turn * turn + 1.0 / (correlation * correlation)) * 2.0 *
             std::pow(std::sin(x), 4) / (x * x);
    }
    EXPECT_NEAR(ifog::returning_variance(correlation, m) / sum, 1.0, 5e-3) << m;
  }
  // Highest at 1.89 correlation times (IEEE Std 952), a walk before, white noise behind.
  const auto at = [&](double m) { return ifog::returning_variance(correlation, m); };
  EXPECT_GT(at(1.89 * correlation), at(1.8 * correlation));
  EXPECT_GT(at(1.89 * correlation), at(2.0 * correlation));
  EXPECT_NEAR(at(0.3) / 0.1, 1.0, 1e-3);
  EXPECT_NEAR(at(3e6) * 3e6 / (correlation * correlation), 1.0, 1e-3);
}

TEST(GaussMarkov, EquivalentTermsHaveItsVarianceAndSlope) {
  ifog::GaussMarkovFit fit;
  fit.correlation = 300.0;
  fit.variances = {0.0, 2.0, 0.0, 0.5};
  const auto variance = [&](double m) {
    return 2.0 / m + 0.5 * ifog::returning_variance(fit.correlation, m);
  };
  for (const double m : {1.0, 100.0, 567.0, 5000.0}) {
    const ifog::TermVariances terms = ifog::equivalent_terms(fit, m);
    const auto law = [&](double at) { return terms[ifog::kN] / at + terms[ifog::kK] * at / 3.0; };
    EXPECT_NEAR(law(m) / variance(m), 1.0, 1e-9) << m;
    EXPECT_NEAR(law(1.01 * m) / law(m), variance(1.01 * m) / variance(m), 1e-3) << m;
  }
}

// The slow part's covariance of a return that takes far longer than the record is the walk's.
TEST(GaussMarkov, AReturnThatTakesForEverIsAWalk) {
  const std::vector<double> rate = ifog::simulate::noise({.N = 1.0}, 1.0, 4000, 3);
  const std::vector<ifog::Stretch> whole{{0, rate.size()}};
  const ifog::AngleSum sum(rate, whole);
  const ifog::NoiseSpectrum walk = ifog::noise_spectrum(sum), slow = ifog::with_return(walk, 1e7);
  for (std::size_t p = 0; p < walk.slow.size(); ++p)
    EXPECT_LT((walk.slow[p].covariance[ifog::kK] - slow.slow[p].covariance[ifog::kK]).norm(),
              2e-3 * walk.slow[p].covariance[ifog::kK].norm());
  for (std::size_t i = 0; i < walk.bins.size(); ++i)
    EXPECT_NEAR(slow.bins[i].expected[ifog::kK] / walk.bins[i].expected[ifog::kK], 1.0, 1e-6);
}

// Oracle: the mean square of what simulated records' slow parts are.
TEST(GaussMarkov, TheSlowPartsCovarianceIsThatOfSimulatedRecords) {
  constexpr std::size_t kSamples = 1000, kRecords = 600;
  const double correlation = 60.0, sigma = 1.0;
  std::vector<double> square;
  ifog::NoiseSpectrum last;
  for (std::size_t r = 0; r < kRecords; ++r) {
    ifog::simulate::GaussMarkov bias(sigma, correlation, 1.0, ifog::simulate::Draw(r, 5));
    std::vector<double> rate(kSamples);
    for (double& value : rate) value = bias.next();
    const std::vector<ifog::Stretch> whole{{0, rate.size()}};
    const ifog::AngleSum sum(rate, whole);
    last = ifog::noise_spectrum(sum);
    square.resize(static_cast<std::size_t>(last.slow[0].value.size()));
    for (std::size_t i = 0; i < square.size(); ++i)
      square[i] += std::pow(last.slow[0].value[static_cast<Eigen::Index>(i)], 2) / kRecords;
  }
  const ifog::NoiseSpectrum expected = ifog::with_return(last, correlation);
  const double drive = 2.0 * sigma * sigma / correlation;
  for (std::size_t i = 0; i < square.size(); ++i) {
    const auto j = static_cast<Eigen::Index>(i);
    EXPECT_NEAR(square[i] / (drive * expected.slow[0].covariance[ifog::kK](j, j)), 1.0,
                4.5 * std::sqrt(2.0 / kRecords))
        << i;
  }
}

// Eight hours of 0.003 °/√h with a bias of 0.1 °/h that remembers 300 s, in units of the white noise.
TEST(GaussMarkov, ABiasThatComesBackIsNamedWithItsTime) {
  std::vector<double> rate = ifog::simulate::noise({.N = 1.0}, 1.0, 28800, 11);
  ifog::simulate::GaussMarkov bias(0.556, 300.0, 1.0, ifog::simulate::Draw(11, 5));
  for (double& value : rate) value += bias.next();
  const std::vector<ifog::Stretch> whole{{0, rate.size()}};
  const ifog::NoiseCoefficients found = ifog::noise_coefficients(ifog::AngleSum(rate, whole), 1.0);
  ASSERT_TRUE(found.markov && found.markov->present);
  EXPECT_LT(found.markov->lower_s, 300.0);
  EXPECT_GT(found.markov->upper_s, 300.0);
  EXPECT_LT(found.markov->upper_s, 900.0);
  EXPECT_NEAR(found.markov->sigma_radps, 0.556, 0.15);
  EXPECT_NEAR(found.markov->walk, 0.556 * std::sqrt(2.0 / 300.0), 0.007);
  EXPECT_GT(found.misfit, 0.5);
  EXPECT_NE(ifog::markov_in_words(found).find("the bias is correlated"), std::string::npos);
}

TEST(GaussMarkov, AWalkAndFlickerAreNotSaidToComeBack) {
  int said = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    for (const auto& levels : {ifog::simulate::NoiseLevels{.N = 1.0, .K = 0.02},
                               ifog::simulate::NoiseLevels{.N = 1.0, .B = 0.3}}) {
      const std::vector<double> rate = ifog::simulate::noise(levels, 1.0, 7200, 400 + seed);
      const std::vector<ifog::Stretch> whole{{0, rate.size()}};
      const auto found = ifog::noise_coefficients(ifog::AngleSum(rate, whole), 1.0);
      said += found.markov && found.markov->present ? 1 : 0;
      EXPECT_EQ(ifog::markov_in_words(found).empty(), !found.markov || !found.markov->present);
    }
  EXPECT_LE(said, 1);
}

}  // namespace
