// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/deviation.h"
#include "drivers/row_times/sample_clock.h"
#include "filters/allan/gapped_deviation.h"
#include "filters/allan/streaming.h"
#include "filters/allan/theo1.h"
#include "tests/unit/capture/read_capture.h"
#include "tests/unit/test.h"
#include "tools/simulate/noise.h"

namespace ifog {
namespace {

// NIST SP 1065, section 12.4: 1000 frequency values by a linear congruence.
std::vector<double> nist_set() {
  std::vector<double> y;
  std::uint64_t n = 1234567890;
  for (int i = 0; i < 1000; ++i) {
    y.push_back(static_cast<double>(n) / 2147483647.0);
    n = 16807 * n % 2147483647;
  }
  return y;
}

std::vector<double> allan(const std::vector<double>& rate, const std::vector<std::size_t>& m,
                          Deviation kind = Deviation::kAllan) {
  const std::vector<Stretch> all{{0, rate.size()}};
  std::vector<double> out;
  for (const auto& p : deviation(AngleSum(rate, all), m, kind)) out.push_back(std::sqrt(p.variance));
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
  std::vector<double> rate = simulate::noise({.N = 1e-6}, 100.0, 60000, 4);
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
      const auto rate = simulate::noise({.N = 1e-6}, 100.0, n, 5);
      const std::vector<Stretch> all{{0, n}};
      const std::size_t longest = longest_average(kind, n);
      const std::vector<std::size_t> m{longest, longest + 1};
      const auto points = deviation(AngleSum(rate, all), m, kind);
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
  const auto points = deviation(AngleSum(rate, parts), m);
  EXPECT_NEAR(points[0].variance, 0.0, 1e-28);
  EXPECT_EQ(points[0].terms, 2U * 149U);
  EXPECT_EQ(points[1].terms, 2U * 131U);
  EXPECT_EQ(points[2].terms, 2U);
  EXPECT_EQ(points[3].terms, 0U);
  EXPECT_TRUE(std::isnan(points[3].variance));
}

// Two recordings that were joined, or a gyro switched off and on (an MPU6050 whose bias stepped by 0.08 °/s): the step
// is at a hole of a second and is no random walk.
TEST(Deviation, NoAverageReachesAcrossAHoleAtWhichTheRateSteps) {
  test::Noise noise(5, 1.0);
  std::vector<double> rate(60000);
  for (double& value : rate) value = noise();
  const std::vector<Stretch> stretches{{0, 30000, 0}, {30100, 60000, 100}};
  EXPECT_EQ(AngleSum(rate, stretches).parts().size(), 1U);
  for (std::size_t i = 30100; i < rate.size(); ++i) rate[i] += 0.5;
  EXPECT_EQ(AngleSum(rate, stretches).parts().size(), 2U);
}

TEST(Deviation, MatchesThePublishedFiguresOfARealGyro) {
  const std::string path = IFOG_SHARED_DATA "/adis16405_imu1.csv.gz";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "needs the measured capture " << path;
  const Capture capture = read_capture(path);
  const auto found = allan(capture.rate_radps[0], {2, 128, 8192, 262144});
  const std::vector<double> published{0.25747, 0.036118, 0.0070628, 0.0057232};  // deg/s
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i] * 180.0 / std::numbers::pi / published[i], 1.0, 0.5e-4)
        << found[i] * 180.0 / std::numbers::pi;
}

const double kMissing = std::numeric_limits<double>::quiet_NaN();

TEST(GappedDeviation, IsThePublishedOneWithoutAGap) {
  const std::vector<std::size_t> m = {1, 10, 100, 400};
  std::vector<double> found = gapped_deviation(nist_set(), m);
  EXPECT_TRUE(std::isnan(found[3]));  // no three averages of 400
  found.pop_back();
  expect_digits(found, {2.922319e-01, 9.159953e-02, 3.241343e-02});
}

// A sample that is missing at the end says nothing: at one sample the published value, at ten within what one
// more average of nine can change.
TEST(GappedDeviation, IsThePublishedOneBesideAMissingSample) {
  std::vector<double> values = nist_set();
  values.push_back(kMissing);
  const std::vector<std::size_t> m = {1, 10};
  const std::vector<double> found = gapped_deviation(values, m);
  EXPECT_NEAR(found[0], 2.922319e-01, 5e-8);
  EXPECT_NEAR(found[1], 9.159953e-02, 1e-3);
}

// Averages of fewer than half of their samples do not count: by hand, means of two over 1 1 3 3 and a hole.
TEST(GappedDeviation, LeavesOutAveragesThatAreMostlyHole) {
  const std::vector<double> values = {1.0, 1.0, 3.0, 3.0, kMissing, kMissing, kMissing, kMissing, 9.0, 9.0};
  const std::vector<std::size_t> m = {2};
  // Neighbouring means: 1 and 3; 2 and 3, the latter of one sample; none across the hole.
  EXPECT_NEAR(gapped_deviation(values, m)[0], std::sqrt(0.5 * (4.0 + 1.0) / 2.0), 1e-12);
  EXPECT_TRUE(std::isnan(gapped_deviation(std::vector<double>(20, kMissing), m)[0]));
}

// The times of rows whose stamps are those of an even clock, off by an amount that is known here.

TEST(RowTimes, StampsOfAnEvenClockAreTaken) {
  const std::vector<double> stamps{5.0, 5.01, 5.02, 5.03, 9.03, 9.04, 9.05};
  RowTimes times(stamps, sample_clock(stamps));
  for (const double stamp : stamps) EXPECT_DOUBLE_EQ(times.next(stamp), stamp - 5.0);
}

TEST(RowTimes, StampsThatScatterGiveWayToTheClockBehindThem) {
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> off(-4e-3, 4e-3);
  std::vector<double> taken, stamps;
  double t = 0.0;
  for (int i = 0; i < 20000; ++i) {
    taken.push_back(t);
    stamps.push_back(1000.0 + t + off(engine));
    t += i == 7000 ? 7200.0 : 0.01;  // two hours without rows
  }
  RowTimes times(stamps, sample_clock(stamps));
  double last = -1.0;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const double now = times.next(stamps[i]);
    if (i != 7001) {
      EXPECT_NEAR(now - last, 0.01, i > 0 ? 1e-6 : 1.0) << i;
    }
    EXPECT_NEAR(now, taken[i], 0.02) << i;
    last = now;
  }
}

TEST(StreamingAllan, FollowsTheWholeRecordsDeviation) {
  auto rate = simulate::noise({.N = 1e-6, .K = 1e-8}, 1.0, 1U << 18U, 3);
  for (double& r : rate) r += 1.0;  // a bias a million times the noise
  StreamingAllan streaming;
  for (const double r : rate) streaming.add(r);
  const std::vector<Stretch> all{{0, rate.size()}};
  std::vector<std::size_t> m;
  for (int k = 0; k < streaming.octaves(); ++k) m.push_back(std::size_t{1} << k);
  ASSERT_EQ(m.size(), 18U);
  const auto points = deviation(AngleSum(rate, all), m);
  for (std::size_t k = 0; k < m.size(); ++k) {
    const double exact = std::sqrt(points[k].variance);
    // Octaves 0 and 1 use every place and are the same sum; above, every quarter: a few per cent of the
    // point's own error.
    const double error = 0.5 * std::sqrt(static_cast<double>(m[k]) / static_cast<double>(rate.size()));
    EXPECT_NEAR(streaming.deviation(static_cast<int>(k)) / exact, 1.0, k < 2 ? 1e-9 : 1e-9 + 0.8 * error)
        << m[k];
  }
}

TEST(StreamingAllan, CountsWhatTheDefinitionCounts) {
  // A ramp of one a sample: every difference at m is m, whatever the place.
  StreamingAllan streaming;
  for (int i = 0; i < 64; ++i) streaming.add(i);
  EXPECT_EQ(streaming.octaves(), 6);
  for (int k = 0; k < 6; ++k) EXPECT_DOUBLE_EQ(streaming.deviation(k), std::exp2(k) / std::sqrt(2.0)) << k;
  EXPECT_EQ(streaming.differences(0), 63U);
  EXPECT_EQ(streaming.differences(1), 61U);
  EXPECT_EQ(streaming.differences(2), 57U);
  EXPECT_EQ(streaming.differences(3), 25U);
  EXPECT_EQ(streaming.differences(5), 1U);
  EXPECT_TRUE(std::isnan(streaming.deviation(6)));
}

TEST(StreamingAllan, NothingReachesAcrossAGap) {
  StreamingAllan streaming;
  for (int i = 0; i < 1000; ++i) streaming.add(1.0);
  streaming.add(std::nan(""));
  for (int i = 0; i < 1000; ++i) streaming.add(5.0);
  streaming.restart();
  for (int i = 0; i < 1000; ++i) streaming.add(-5.0);
  for (int k = 0; k < streaming.octaves(); ++k) EXPECT_EQ(streaming.deviation(k), 0.0);
  EXPECT_EQ(streaming.differences(0), 3U * 999U);
}

// NIST SP 1065, section 5.2.18: bias of Thêo1 against the Allan variance in the mean, a + b/m^c, by
// simulation of long records; W FM 1, F FM 1.87 − 1.05/m^0.79, RW FM 2.70 − 1.53/m^0.85.
TEST(Theo1, BiasIsTheHandbooks) {
  const struct {
    simulate::NoiseLevels levels;
    TermVariances terms;
    double a, b, c;
  } cases[] = {{{.N = 1.0}, {0, 1, 0, 0}, 1.0, 0.0, 1.0},
               {{.B = 1.0}, {0, 0, 1, 0}, 1.87, -1.05, 0.79},
               {{.K = 1.0}, {0, 0, 0, 1}, 2.70, -1.53, 0.85}};
  for (const auto& c : cases) {
    const auto rate = simulate::noise(c.levels, 1.0, 256, 1);
    const std::vector<Stretch> all{{0, rate.size()}};
    for (const LongPoint& point : theo1(AngleSum(rate, all), c.terms, 0.683, 5)) {
      const double m = point.tau / 0.75;
      EXPECT_NEAR(point.bias / (c.a + c.b / std::pow(m, c.c)), 1.0, 0.05) << "tau " << point.tau;
      EXPECT_GT(point.tau, 64.0);
      EXPECT_LE(point.tau, 0.75 * 256);
    }
  }
}

TEST(Theo1, ReachesThreeQuartersOfTheRecord) {
  const auto rate = simulate::noise({.N = 1.0}, 1.0, 5000, 2);
  const std::vector<Stretch> all{{0, rate.size()}};
  const auto points = theo1(AngleSum(rate, all), {0, 1, 0, 0}, 0.683, 10);
  ASSERT_FALSE(points.empty());
  EXPECT_NEAR(points.back().tau, 3750.0, 75.0);
}

// At the longest τ an Allan variance has one difference; Thêo1 says more, and its interval holds.
TEST(Theo1, IntervalsHoldTheAllanVarianceOfAMixture) {
  constexpr int kRecords = 100;
  const TermVariances terms{0.0, 1.0, 0.0, 1e-4};
  std::vector<int> inside;
  for (int record = 0; record < kRecords; ++record) {
    const auto rate = simulate::noise({.N = 1.0, .K = 1e-2}, 1.0, 256, static_cast<std::uint64_t>(record));
    const std::vector<Stretch> all{{0, rate.size()}};
    const auto points = theo1(AngleSum(rate, all), terms, 0.683, 4);
    inside.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double truth = std::sqrt(1.0 / points[i].tau + 1e-4 * points[i].tau / 3.0);
      inside[i] += truth >= points[i].interval.lower_radps && truth <= points[i].interval.upper_radps ? 1 : 0;
    }
  }
  // Three standard errors of the count.
  for (const int n : inside) EXPECT_NEAR(n / double{kRecords}, 0.683, 0.14);
}

}  // namespace
}  // namespace ifog
