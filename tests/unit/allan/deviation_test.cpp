// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/deviation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <vector>

#include "tests/unit/allan/nist_set.h"
#include "tests/unit/capture/read_capture.h"
#include "tools/simulate/noise.h"

namespace {

using ifog::AngleSum;
using ifog::Deviation;
using ifog::nist_set;
using ifog::Stretch;

std::vector<double> allan(const std::vector<double>& rate, const std::vector<std::size_t>& m,
                          Deviation kind = Deviation::kAllan) {
  const std::vector<Stretch> all{{0, rate.size()}};
  std::vector<double> out;
  for (const auto& p : ifog::deviation(AngleSum(rate, all), m, kind)) out.push_back(std::sqrt(p.variance));
  return out;
}

void expect_digits(const std::vector<double>& found, const std::vector<double>& published) {
  ASSERT_EQ(found.size(), published.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i] / published[i], 1.0, 0.5e-6 / 2.0) << found[i] << " for " << published[i];
}

TEST(Deviation, NistThousandPointSet) {
  const std::vector<std::size_t> m{1, 10, 100};
  expect_digits(allan(nist_set(), m), {2.922319e-01, 9.159953e-02, 3.241343e-02});
  expect_digits(allan(nist_set(), m, Deviation::kModified), {2.922319e-01, 6.172376e-02, 2.170921e-02});
  expect_digits(allan(nist_set(), m, Deviation::kHadamard), {2.943883e-01, 9.581083e-02, 3.237638e-02});
}

// The definition, in long double and without a running sum.
double by_definition(const std::vector<double>& rate, std::size_t m) {
  long double squares = 0.0L;
  const std::size_t terms = rate.size() - 2 * m + 1;
  for (std::size_t i = 0; i < terms; ++i) {
    long double d = 0.0L;
    for (std::size_t k = 0; k < m; ++k) d += static_cast<long double>(rate[i + m + k]) - rate[i + k];
    squares += d * d;
  }
  const auto n = static_cast<long double>(m);
  return static_cast<double>(std::sqrt(squares / (2.0L * n * n * static_cast<long double>(terms))));
}

TEST(Deviation, LargeBiasAndRampCostNoDigits) {
  std::vector<double> rate = ifog::simulate::noise({.N = 1e-6}, 100.0, 60000, 4);
  for (std::size_t i = 0; i < rate.size(); ++i) rate[i] += 3.0 + 2e-9 * static_cast<double>(i);
  for (const std::size_t m : {1U, 7U, 300U, 29999U})
    EXPECT_NEAR(allan(rate, {m})[0] / by_definition(rate, m), 1.0, 1e-12) << m;
}

// All second differences of a ramp are equal: m a / sqrt(2) for a per sample. Long averages are computed one by one.
TEST(Deviation, AModifiedOneOfARampIsItsSlopeHoweverLong) {
  std::vector<double> rate(7'500'000);
  for (std::size_t i = 0; i < rate.size(); ++i) rate[i] = 1e-9 * static_cast<double>(i);
  const std::vector<std::size_t> m{2'390'000, 2'500'000};
  const std::vector<double> found = allan(rate, m, Deviation::kModified);
  for (std::size_t k = 0; k < m.size(); ++k)
    EXPECT_NEAR(found[k] / (1e-9 * static_cast<double>(m[k]) / std::numbers::sqrt2), 1.0, 1e-9);
}

TEST(Deviation, TheLongestAverageIsTheLastWithADifference) {
  for (const Deviation kind : {Deviation::kAllan, Deviation::kModified, Deviation::kHadamard})
    for (const std::size_t n : {64U, 65U, 66U, 67U, 68U, 69U}) {
      const auto rate = ifog::simulate::noise({.N = 1e-6}, 100.0, n, 5);
      const std::vector<Stretch> all{{0, n}};
      const std::size_t longest = ifog::longest_average(kind, n);
      const std::vector<std::size_t> m{longest, longest + 1};
      const auto points = ifog::deviation(AngleSum(rate, all), m, kind);
      EXPECT_GT(points[0].terms, 0U) << n;
      EXPECT_EQ(points[1].terms, 0U) << n;
    }
}

TEST(Deviation, StretchesNeverMixAcrossAHole) {
  // Two stretches at different rates: the step between them must not appear at any averaging time.
  std::vector<double> rate(300, 1.0);
  for (std::size_t i = 150; i < 300; ++i) rate[i] = 2.0;
  const std::vector<Stretch> parts{{0, 150}, {150, 300}};
  const std::vector<std::size_t> m{1, 10, 75, 76};
  const auto points = ifog::deviation(AngleSum(rate, parts), m);
  EXPECT_NEAR(points[0].variance, 0.0, 1e-28);
  EXPECT_EQ(points[0].terms, 2U * 149U);
  EXPECT_EQ(points[1].terms, 2U * 131U);
  EXPECT_EQ(points[2].terms, 2U);
  EXPECT_EQ(points[3].terms, 0U);
  EXPECT_TRUE(std::isnan(points[3].variance));
}

TEST(Deviation, MatchesThePublishedFiguresOfARealGyro) {
  const std::string path = IFOG_SHARED_DATA "/adis16405_imu1.csv.gz";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "needs the measured capture " << path;
  const ifog::Capture capture = ifog::read_capture(path);
  const auto found = allan(capture.rate_radps[0], {2, 128, 8192, 262144});
  const std::vector<double> published{0.25747, 0.036118, 0.0070628, 0.0057232};  // deg/s
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i] * 180.0 / std::numbers::pi / published[i], 1.0, 0.5e-4)
        << found[i] * 180.0 / std::numbers::pi;
}

}  // namespace
