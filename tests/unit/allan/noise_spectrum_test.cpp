// SPDX-License-Identifier: Apache-2.0
// What the numbers taken of a record are expected to scatter like, against closed forms.
#include "filters/allan/noise/noise_spectrum.h"
#include "filters/allan/noise/angle_means.h"
#include "filters/allan/noise/gauss_markov.h"
#include "filters/allan/noise/noise_coefficients.h"
#include "filters/allan/power_law.h"
#include "tests/unit/test.h"
#include "tools/simulate/noise.h"

namespace {

using ifog::NoiseSpectrum;
using ifog::TermVariances;

NoiseSpectrum spectrum_of(std::size_t samples) {
  const auto rate = ifog::simulate::noise({.N = 1.0}, 1.0, samples, 1);
  const std::vector<ifog::Stretch> all{{0, rate.size()}};
  return ifog::noise_spectrum(ifog::AngleSum(rate, all));
}

// The cosines are orthonormal, and are what a random walk is made of: 1/(4 sin²(πk/2n)), less the sixth that
// averaging over a sample takes. Flicker by the double sum. A ramp is odd about the middle.
TEST(NoiseSpectrum, TheSlowCosinesScatterAsTheClosedFormsSay) {
  for (const std::size_t n : {300U, 301U}) {
    const NoiseSpectrum spectrum = spectrum_of(n);
    const std::span<const TermVariances> lag = ifog::level_covariance(0);
    const double length = static_cast<double>(n);
    ASSERT_EQ(spectrum.slow.size(), 32U);
    for (const std::size_t k : {1U, 2U, 3U, 32U}) {
      const ifog::SlowCosine& cosine = spectrum.slow[k - 1];
      const double turn = std::numbers::pi * static_cast<double>(k) / length;
      const double walk = 0.25 / std::pow(std::sin(0.5 * turn), 2) - 1.0 / 6.0;
      EXPECT_NEAR(cosine.frequency, turn / (2.0 * std::numbers::pi), 1e-15);
      EXPECT_NEAR(cosine.expected[ifog::kN], 1.0, 1e-9);
      EXPECT_NEAR(cosine.expected[ifog::kK] / walk, 1.0, 1e-6);
      EXPECT_EQ(std::abs(cosine.ramp) < 1e-9, k % 2 == 0);
      const auto w = [&](std::size_t i) {
        return std::sqrt(2.0 / length) * std::cos(turn * (static_cast<double>(i) + 0.5));
      };
      double flicker = 0.0;
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) flicker += w(i) * w(j) * lag[i > j ? i - j : j - i][ifog::kB];
      EXPECT_NEAR(cosine.expected[ifog::kB] / flicker, 1.0, 1e-9);
    }
  }
}

using ifog::Deviation;

TEST(PowerLaw, MeansAreTheStandards) {
  for (const std::size_t m : {1U, 3U, 100U}) {
    const double x = static_cast<double>(m);
    EXPECT_NEAR(ifog::expected_variance(Deviation::kAllan, ifog::kQ, m) * x * x, 3.0, 1e-12);
    EXPECT_NEAR(ifog::expected_variance(Deviation::kAllan, ifog::kN, m) * x, 1.0, 1e-12);
    EXPECT_NEAR(ifog::expected_variance(Deviation::kAllan, ifog::kB, m),
                2.0 * std::numbers::ln2 / std::numbers::pi, 1e-12);
    EXPECT_NEAR(ifog::expected_variance(Deviation::kAllan, ifog::kK, m) * 3.0 / x, 1.0, 1e-12);
    // NIST SP 1065, table of Hadamard variances: 10/3, 1, (8 ln 2 − 3 ln 3)/π·…, 1/6.
    EXPECT_NEAR(ifog::expected_variance(Deviation::kHadamard, ifog::kQ, m) * x * x, 10.0 / 3.0, 1e-12);
    EXPECT_NEAR(ifog::expected_variance(Deviation::kHadamard, ifog::kN, m) * x, 1.0, 1e-12);
    EXPECT_NEAR(ifog::expected_variance(Deviation::kHadamard, ifog::kK, m) * 6.0 / x, 1.0, 1e-12);
  }
}

// Weights of the phases whose sum is one difference: third differences for Hadamard's, means of m for the modified one.
std::vector<double> weights_of(Deviation kind, std::size_t m) {
  const std::vector<double> difference = kind == Deviation::kHadamard
                                             ? std::vector<double>{-1.0, 3.0, -3.0, 1.0}
                                             : std::vector<double>{1.0, -2.0, 1.0};
  const std::size_t mean_of = kind == Deviation::kModified ? m : 1;
  std::vector<double> out((difference.size() - 1) * m + mean_of, 0.0);
  for (std::size_t k = 0; k < mean_of; ++k)
    for (std::size_t i = 0; i < difference.size(); ++i)
      out[i * m + k] += difference[i] / static_cast<double>(mean_of);
  return out;
}

// The variance of an estimate from n samples by its definition: the covariances of all pairs of places (Greenhall and Riley,
// "Uncertainty of stability variances based on finite differences", 35th PTTI, 2003; NIST SP 1065, section 5.4.1).
double by_definition(Deviation kind, std::size_t n, std::size_t m, const ifog::TermVariances& v) {
  const std::vector<double> w = weights_of(kind, m);
  const auto length = static_cast<int>(w.size()), places = static_cast<int>(n) + 2 - length;
  std::vector<long double> of_phases;  // so many samples apart, as far as it matters to differences
  for (int apart = 0; apart < places + length; ++apart) {
    const long double a = apart, square = a * a;
    of_phases.push_back(
        (apart == 0 ? v[0] : 0.0L) - 0.5L * v[1] * a + v[3] * square * a / 12.0L +
        (apart == 0 ? 0.0L : v[2] * square * std::log(a) / (2.0L * std::numbers::pi_v<long double>)));
  }
  std::vector<std::pair<int, long double>> pairs;  // of weights: how far apart, and the sum of their products
  for (int apart = 1 - length; apart < length; ++apart) {
    long double product = 0.0L;
    for (int i = std::max(0, -apart); i < std::min(length, length - apart); ++i)
      product +=
          static_cast<long double>(w[static_cast<std::size_t>(i)]) * w[static_cast<std::size_t>(i + apart)];
    if (product != 0.0L) pairs.emplace_back(apart, product);
  }
  long double sum = 0.0L;
  for (int lag = 0; lag < places; ++lag) {
    long double covariance = 0.0L;
    for (const auto& [apart, product] : pairs)
      covariance += product * of_phases[static_cast<std::size_t>(std::abs(lag + apart))];
    sum += (lag == 0 ? 1.0L : 2.0L) * (places - lag) * 2.0L * covariance * covariance;
  }
  const double scale = (kind == Deviation::kHadamard ? 6.0 : 2.0) * static_cast<double>(m * m) * places;
  return static_cast<double>(sum) / (scale * scale);
}

TEST(PowerLaw, TheVarianceOfAnEstimateIsTheSumOverAllPairsOfPlaces) {
  const std::vector<std::size_t> samples{5000};
  for (const Deviation kind : {Deviation::kAllan, Deviation::kModified, Deviation::kHadamard})
    for (const std::size_t m : {1U, 2U, 7U, 40U, 300U, 1250U})
      for (const TermVariances& v :
           {TermVariances{2.5, 0, 0, 0}, TermVariances{0, 2.5, 0, 0}, TermVariances{0, 0, 2.5, 0},
            TermVariances{0, 0, 0, 2.5}, TermVariances{2, 0.5, 0.2, 1e-3}}) {
        const ifog::EstimateVariance found(kind, m, samples);
        const double expected = by_definition(kind, 5000, m, v), mean = ifog::expected_variance(kind, v, m);
        EXPECT_NEAR(found.at(v) / expected, 1.0, 2e-3)
            << static_cast<int>(kind) << " m " << m << " N " << v[1];
        EXPECT_NEAR(found.degrees(v) / (2.0 * mean * mean / expected), 1.0, 2e-3)
            << static_cast<int>(kind) << " m " << m;
      }
}

// IEEE Std 952, annex C: exponentially correlated noise of drive q and time T.
TEST(GaussMarkov, ItsAllanVarianceIsTheStandardsIntegral) {
  const double correlation = 300.0;
  for (const double m : {0.1, 1.0, 30.0, 300.0, 567.0, 3000.0, 1e5}) {
    // The one-sided spectrum q²/(ω² + 1/T²), weighted by 2 sin⁴(πfm)/(πfm)².
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
  EXPECT_TRUE(ifog::test::has(ifog::markov_in_words(found), "the bias is correlated"));
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
