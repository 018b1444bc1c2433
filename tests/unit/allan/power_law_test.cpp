#include "filters/allan/power_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "filters/allan/confidence.h"
#include "tools/simulate/noise.h"

namespace {

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

TEST(PowerLaw, CovarianceIsTheSumOverAllPairsOfPlaces) {
  const std::vector<std::size_t> m{1, 5, 64, 200};
  const std::vector<std::size_t> samples{600};
  const ifog::DifferenceCovariance covariance(Deviation::kAllan, m, samples);
  for (const ifog::TermVariances& v :
       {ifog::TermVariances{1, 0, 0, 0}, ifog::TermVariances{0, 1, 0, 0}, ifog::TermVariances{0, 0, 1, 0},
        ifog::TermVariances{0, 0, 0, 1}, ifog::TermVariances{2, 0.5, 0.2, 1e-3}}) {
    const auto found = covariance.at(v);
    for (std::size_t i = 0; i < m.size(); ++i)
      for (std::size_t j = i; j < m.size(); ++j) {
        const double expected = by_brute_force(600, m[i], m[j], v);
        // Near zero the correlation is what matters.
        const double scale = std::sqrt(found[i * 4 + i] * found[j * 4 + j]);
        EXPECT_NEAR(found[i * 4 + j] / scale, expected / scale, 2e-4)
            << m[i] << ' ' << m[j] << " v0 " << v[0];
      }
  }
}

// Riley's table against the exact variance: 2σ⁴/Var. The table claims a few per cent.
TEST(PowerLaw, DegreesOfFreedomAgreeWithTheHandbook) {
  const std::vector<std::size_t> m{1, 10, 100, 1000};
  const std::vector<std::size_t> samples{10000};
  const ifog::DifferenceCovariance covariance(Deviation::kAllan, m, samples);
  const struct {
    ifog::TermVariances v;
    ifog::Term term;
    ifog::NoiseType type;
  } cases[] = {{{1, 0, 0, 0}, ifog::kQ, ifog::NoiseType::kQuantisation},
               {{0, 1, 0, 0}, ifog::kN, ifog::NoiseType::kAngleRandomWalk},
               {{0, 0, 1, 0}, ifog::kB, ifog::NoiseType::kBiasInstability},
               {{0, 0, 0, 1}, ifog::kK, ifog::NoiseType::kRateRandomWalk}};
  for (const auto& c : cases) {
    const auto found = covariance.at(c.v);
    for (std::size_t i = 0; i < m.size(); ++i) {
      const double mean = ifog::expected_variance(Deviation::kAllan, c.term, m[i]);
      const double degrees = 2.0 * mean * mean / found[i * m.size() + i];
      EXPECT_NEAR(ifog::allan_degrees_of_freedom(c.type, 10000, m[i]) / degrees, 1.0, 0.15)
          << "alpha " << static_cast<int>(c.type) << " m " << m[i] << " exact " << degrees;
    }
  }
}

TEST(PowerLaw, CovarianceOfHadamardVariancesAgreesWithTheScatter) {
  const std::vector<std::size_t> m{1, 8, 64, 256};
  const std::vector<std::size_t> samples{1024};
  const ifog::TermVariances v{0.0, 1.0, 0.02, 1e-4};
  const auto expected = ifog::DifferenceCovariance(Deviation::kHadamard, m, samples).at(v);
  std::vector<double> found(16);
  constexpr int kRecords = 4000;
  for (int record = 0; record < kRecords; ++record) {
    const auto rate = ifog::simulate::noise({.N = 1.0, .B = std::sqrt(0.02), .K = 1e-2}, 1.0, 1024,
                                            static_cast<std::uint64_t>(record));
    const std::vector<ifog::Stretch> all{{0, rate.size()}};
    const auto points = ifog::deviation(ifog::AngleSum(rate, all), m, Deviation::kHadamard, 1);
    std::array<double, 4> d{};
    for (std::size_t i = 0; i < 4; ++i) {
      d[i] = points[i].variance;
      for (std::size_t t = 0; t < ifog::kTerms; ++t)
        d[i] -= v[t] * ifog::expected_variance(Deviation::kHadamard, static_cast<ifog::Term>(t), m[i]);
    }
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) found[i * 4 + j] += d[i] * d[j] / kRecords;
  }
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i; j < 4; ++j) {
      const double scale = std::sqrt(expected[i * 4 + i] * expected[j * 4 + j]);
      EXPECT_NEAR(found[i * 4 + j] / scale, expected[i * 4 + j] / scale, i == j ? 0.15 : 0.08)
          << m[i] << ' ' << m[j];
    }
}

}  // namespace
