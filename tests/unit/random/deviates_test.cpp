// SPDX-License-Identifier: Apache-2.0
// Our logarithm and exponential against the C library's in extended precision; the deviates against the
// moments of their laws.
#include "filters/random/deviates.h"
#include "filters/random/log_exp.h"
#include "filters/random/philox.h"
#include "tests/unit/test.h"

namespace {

using ifog::DeviateStream;

// Error in units of the last place of the exact value.
double ulps(double got, long double exact) {
  const auto rounded = static_cast<double>(exact);
  const double unit = std::nextafter(std::abs(rounded), INFINITY) - std::abs(rounded);
  return static_cast<double>(std::abs(static_cast<long double>(got) - exact)) / unit;
}

TEST(Logarithm, AgreesWithExtendedPrecision) {
  double worst = 0.0;
  for (int i = 1; i < 2'000'000; ++i) {
    const double x = (i + 0.5) / 2'000'000.0;
    worst = std::max(worst, ulps(ifog::logarithm(x), std::log(static_cast<long double>(x))));
  }
  for (int k = -1000; k < 1000; ++k) {
    const double x = std::ldexp(1.2345, k);
    worst = std::max(worst, ulps(ifog::logarithm(x), std::log(static_cast<long double>(x))));
  }
  EXPECT_LT(worst, 2.0);
  EXPECT_EQ(ifog::logarithm(1.0), 0.0);
}

TEST(Exponential, AgreesWithExtendedPrecision) {
  double worst = 0.0;
  for (int i = 0; i < 95'000; ++i) {
    const double x = -650.0 + 0.0137 * i;
    const long double exact = std::exp(static_cast<long double>(x));
    worst = std::max(worst, static_cast<double>(std::abs((ifog::exponential(x) - exact) / exact)));
  }
  EXPECT_LT(worst, 1e-15);
}

// Mean 1 and variance 1 of Exp(1); mean 1/2, variance 1/12 of U(0,1). Bounds: five standard errors.
TEST(Deviates, HaveTheMomentsOfTheirLaws) {
  constexpr int kCount = 1'000'000;
  DeviateStream exponential(7, 0, DeviateStream::Law::kExponential);
  DeviateStream uniform(7, 0, DeviateStream::Law::kUniform);
  double e1 = 0, e2 = 0, u1 = 0, u2 = 0, lag = 0, before = 0;
  for (int i = 0; i < kCount; ++i) {
    const double e = exponential.at(static_cast<std::uint64_t>(i), 0);
    const double u = uniform.at(static_cast<std::uint64_t>(i), 0);
    e1 += e;
    e2 += e * e;
    lag += (e - 1) * before;
    before = e - 1;
    u1 += u;
    u2 += (u - 0.5) * (u - 0.5);
  }
  const double root = std::sqrt(kCount);
  EXPECT_NEAR(e1 / kCount, 1.0, 5 * 1.0 / root);
  EXPECT_NEAR(e2 / kCount, 2.0, 5 * std::sqrt(20.0) / root);
  EXPECT_NEAR(lag / kCount, 0.0, 5 * 1.0 / root);
  EXPECT_NEAR(u1 / kCount, 0.5, 5 * std::sqrt(1.0 / 12) / root);
  EXPECT_NEAR(u2 / kCount, 1.0 / 12, 5 * std::sqrt(1.0 / 180) / root);
}

TEST(Deviates, DependOnSeedStreamRowAndIndexOnly) {
  DeviateStream forward(3, 1, DeviateStream::Law::kExponential);
  DeviateStream backward(3, 1, DeviateStream::Law::kExponential);
  std::vector<double> drawn;
  for (std::uint64_t i = 0; i < 100; ++i) drawn.push_back(forward.at(i, 2));
  for (std::uint64_t i = 100; i-- > 0;) EXPECT_EQ(backward.at(i, 2), drawn[i]);
  EXPECT_NE(DeviateStream(4, 1, DeviateStream::Law::kExponential).at(0, 2), drawn[0]);
  EXPECT_NE(DeviateStream(3, 2, DeviateStream::Law::kExponential).at(0, 2), drawn[0]);
  EXPECT_NE(forward.at(0, 3), drawn[0]);
  // Longer than what is drawn at one go, and a prefix of odd length.
  std::vector<double> row(150), again(150), shorter(7);
  forward.fill(9, 0, row);
  backward.fill(9, 0, again);
  EXPECT_EQ(row, again);
  DeviateStream(3, 1, DeviateStream::Law::kExponential).fill(9, 0, shorter);
  for (std::size_t i = 0; i < shorter.size(); ++i) EXPECT_EQ(shorter[i], row[i]);
}

// A replay promises the same bits from every build on every machine, so they are written down. The decimals
// next to them are -ln((bits + 1/2) 2^-32) by a second implementation, in integers and forty decimal digits.
TEST(Deviates, AreTheSameBitsEverywhere) {
  DeviateStream stream(42, 7, DeviateStream::Law::kExponential);
  std::array<double, 6> row{};
  stream.fill(123456789012345, 2, row);
  constexpr std::array kBits{0x1.29e2a97f8300dp+1, 0x1.009098d157966p+1, 0x1.0eae3b2fa8fc5p-6,
                             0x1.27fe20e67edcap-2, 0x1.06d1f47df43fbp-2, 0x1.58c452e0e5d64p+0};
  constexpr std::array kExact{2.32722967840346, 2.00441274854626, 0.01652103214168,
                              0.28905536085923, 0.25666028994360, 1.34674566260026};
  for (std::size_t i = 0; i < row.size(); ++i) {
    EXPECT_EQ(row[i], kBits[i]) << i;
    EXPECT_NEAR(row[i], kExact[i], 1e-11) << i;
  }
  EXPECT_EQ(stream.at(1000001, 2), 0x1.5cee5c248deaap-7);
  EXPECT_NEAR(stream.at(1000001, 2), 0.01064853190574, 1e-11);
}

// Known answers of Random123's own test file (kat_vectors, philox4x32 and philox4x64, 10 rounds).

using ifog::philox;
using ifog::PhiloxBlock;

TEST(Philox, GivesThePublishedAnswers) {
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (PhiloxBlock{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  constexpr std::uint32_t kAll = 0xffffffff;
  EXPECT_EQ(philox({kAll, kAll, kAll, kAll}, {kAll, kAll}),
            (PhiloxBlock{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (PhiloxBlock{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

}  // namespace
