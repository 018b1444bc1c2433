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

// The algorithm of Greenhall and Riley ("Uncertainty of stability variances based on finite differences",
// 35th PTTI, 2003; NIST SP 1065, section 5.4.1) for one power law of the phase, in its own notation, every
// lag summed: α 2, 0, −1, −2 for Q, N, B, K.
class GreenhallRiley {
 public:
  GreenhallRiley(int alpha, Deviation kind, double m)
      : alpha_(alpha),
        d_(kind == Deviation::kHadamard ? 3 : 2),
        sampled_(kind != Deviation::kModified),
        m_(m),
        F_(kind == Deviation::kModified ? 1 : m) {}

  [[nodiscard]] double degrees(double phases) const {
    const double S = m_, L = m_ / F_ + m_ * d_;
    const double M = 1 + std::floor(S * (phases - L) / m_), J = std::min(M, (d_ + 1) * S);
    double sum = sz(0) * sz(0) + (1 - J / M) * sz(J / S) * sz(J / S);
    for (double j = 1; j < J; ++j) sum += 2 * (1 - j / M) * sz(j / S) * sz(j / S);
    return sz(0) * sz(0) * M / sum;
  }

 private:
  [[nodiscard]] static long double sw(long double t, int alpha) {
    const long double a = std::abs(t);
    switch (alpha) {
      case 2:
        return -a;
      case 1:
        return a > 0 ? a * a * std::log(a) : 0;
      case 0:
        return a * a * a;
      case -1:
        return a > 0 ? -a * a * a * a * std::log(a) : 0;
      default:
        return -a * a * a * a * a;
    }
  }
  // F: samples of phase averaged, in units of 1/m; rate noise is sampled as it is, F infinite.
  [[nodiscard]] long double sx(long double t) const {
    if (sampled_ && alpha_ < 2) return sw(t, alpha_ + 2);
    return F_ * F_ * (2 * sw(t, alpha_) - sw(t - 1.0L / F_, alpha_) - sw(t + 1.0L / F_, alpha_));
  }
  [[nodiscard]] double sz(long double t) const {
    const long double near = sx(t - 1) + sx(t + 1), far = sx(t - 2) + sx(t + 2);
    if (d_ == 2) return static_cast<double>(6 * sx(t) - 4 * near + far);
    return static_cast<double>(20 * sx(t) - 15 * near + 6 * far - sx(t - 3) - sx(t + 3));
  }
  int alpha_, d_;
  bool sampled_;
  double m_, F_;
};

TEST(PowerLaw, DegreesOfFreedomAreGreenhallsAndRileys) {
  const std::array<int, ifog::kTerms> alpha{2, 0, -1, -2};
  for (const Deviation kind : {Deviation::kAllan, Deviation::kModified, Deviation::kHadamard})
    for (std::size_t t = 0; t < ifog::kTerms; ++t)
      for (const std::size_t m : {1U, 2U, 7U, 40U, 300U, 1250U}) {
        const std::vector<std::size_t> samples{5000};
        ifog::TermVariances v{};
        v[t] = 2.5;
        const double found = ifog::EstimateVariance(kind, m, samples).degrees(v);
        const double theirs = GreenhallRiley(alpha[t], kind, static_cast<double>(m)).degrees(5001);
        // Theirs averages the phase over time where the modified deviation sums samples: at long m alike. And
        // it stops at the difference's length; flicker goes a little further.
        if (kind == Deviation::kModified && m < 40) continue;
        EXPECT_NEAR(found / theirs, 1.0, kind == Deviation::kModified || t == ifog::kB ? 0.01 : 2e-3)
            << static_cast<int>(kind) << " term " << t << " m " << m << " found " << found;
      }
}

// Second method: all pairs of places of a short record, one by one.
double by_brute_force(std::size_t n, std::size_t m1, std::size_t m2, const ifog::TermVariances& v) {
  const double w[3] = {1.0, -2.0, 1.0};
  const auto covariance = [&](double t) {
    const double a = std::abs(t);
    return (a == 0.0 ? v[0] : 0.0) - 0.5 * v[1] * a +
           (a > 0 ? v[2] * a * a * std::log(a) / (2 * std::numbers::pi) : 0) + v[3] * a * a * a / 12.0;
  };
  const std::size_t p1 = n + 1 - 2 * m1, p2 = n + 1 - 2 * m2;
  double sum = 0.0;
  for (std::size_t i = 0; i < p1; ++i)
    for (std::size_t j = 0; j < p2; ++j) {
      double gamma = 0.0;
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b)
          gamma +=
              w[a] * w[b] * covariance(static_cast<double>(i + a * m1) - static_cast<double>(j + b * m2));
      sum += 2.0 * gamma * gamma;
    }
  const auto sq = [](std::size_t m) { return static_cast<double>(m) * static_cast<double>(m); };
  return sum / (4.0 * sq(m1) * sq(m2) * static_cast<double>(p1) * static_cast<double>(p2));
}

TEST(PowerLaw, TheVarianceIsTheSumOverAllPairsOfPlacesOfAMixture) {
  const std::vector<std::size_t> samples{600};
  for (const std::size_t m : {1U, 5U, 64U, 200U})
    for (const ifog::TermVariances& v : {ifog::TermVariances{1, 0, 0, 0}, ifog::TermVariances{0, 0, 1, 0},
                                         ifog::TermVariances{2, 0.5, 0.2, 1e-3}}) {
      const double found = ifog::EstimateVariance(Deviation::kAllan, m, samples).at(v);
      EXPECT_NEAR(found / by_brute_force(600, m, m, v), 1.0, 2e-4) << m << " v0 " << v[0];
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
