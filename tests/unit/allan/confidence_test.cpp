#include "filters/allan/confidence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tools/simulate/noise.h"

namespace {

using ifog::NoiseType;

// Abramowitz and Stegun, table 26.8, and the median and tails of the exponential distribution (two degrees of
// freedom).
TEST(Confidence, ChiSquaredQuantilesAreTheTables) {
  EXPECT_NEAR(ifog::chi_squared_quantile(0.95, 1.0), 3.84146, 5e-6);
  EXPECT_NEAR(ifog::chi_squared_quantile(0.95, 10.0), 18.3070, 5e-5);
  EXPECT_NEAR(ifog::chi_squared_quantile(0.05, 30.0), 18.49266, 5e-5);
  EXPECT_NEAR(ifog::chi_squared_quantile(0.995, 100.0), 140.169, 5e-4);
  for (const double p : {1e-6, 0.16, 0.5, 0.999})
    EXPECT_NEAR(ifog::chi_squared_quantile(p, 2.0) / (-2.0 * std::log1p(-p)), 1.0, 1e-10) << p;
  // Wilson–Hilferty, good to 1e-6 at a million degrees.
  EXPECT_NEAR(ifog::chi_squared_quantile(0.841344746, 1e6) / 1e6,
              std::pow(1.0 - 2.0 / 9e6 + std::sqrt(2.0 / 9e6), 3), 1e-8);
}

TEST(Confidence, NamesThePureNoises) {
  const struct {
    ifog::simulate::NoiseLevels levels;
    NoiseType type;
  } cases[] = {{{.N = 1.0}, NoiseType::kAngleRandomWalk},
               {{.B = 1.0}, NoiseType::kBiasInstability},
               {{.K = 1.0}, NoiseType::kRateRandomWalk}};
  for (const auto& c : cases) {
    const auto rate = ifog::simulate::noise(c.levels, 1.0, 20000, 2);
    const std::vector<ifog::Stretch> all{{0, rate.size()}};
    const ifog::AngleSum sum(rate, all);
    for (const std::size_t m : {1U, 20U})
      EXPECT_EQ(ifog::noise_type(sum, m, NoiseType::kFlickerPhase), c.type)
          << static_cast<int>(c.type) << " m " << m;
  }
  std::vector<double> phase_noise(20001);
  ifog::simulate::Draw draw(3);
  double before = draw.normal();
  for (double& y : phase_noise) {
    const double now = draw.normal();
    y = now - before;
    before = now;
  }
  const std::vector<ifog::Stretch> all{{0, phase_noise.size()}};
  EXPECT_EQ(ifog::noise_type(ifog::AngleSum(phase_noise, all), 1, NoiseType::kAngleRandomWalk),
            NoiseType::kQuantisation);
  EXPECT_EQ(ifog::noise_type(ifog::AngleSum(phase_noise, all), 16, NoiseType::kAngleRandomWalk),
            NoiseType::kQuantisation);
  EXPECT_EQ(ifog::noise_type(ifog::AngleSum(phase_noise, all), 1000, NoiseType::kBiasInstability),
            NoiseType::kBiasInstability);
}

// The interval must hold the true deviation as often as it says, by simulation.
TEST(Confidence, IntervalsCoverTheTruth) {
  constexpr int kRecords = 400;
  const std::vector<std::size_t> m{1, 8, 64, 256};
  const struct {
    ifog::simulate::NoiseLevels levels;
    double (*truth)(double tau);
  } cases[] = {{{.N = 1.0}, [](double tau) { return 1.0 / std::sqrt(tau); }},
               {{.B = 1.0}, [](double) { return std::sqrt(2.0 * std::log(2.0) / M_PI); }},
               {{.K = 1.0}, [](double tau) { return std::sqrt(tau / 3.0); }}};
  for (const auto& c : cases) {
    std::vector<int> inside(m.size());
    for (int record = 0; record < kRecords; ++record) {
      const auto rate = ifog::simulate::noise(c.levels, 1.0, 2048, 1000 + static_cast<std::uint64_t>(record));
      const std::vector<ifog::Stretch> all{{0, rate.size()}};
      const ifog::AngleSum sum(rate, all);
      const auto points = ifog::deviation(sum, m, ifog::Deviation::kAllan, 1);
      const auto intervals = ifog::allan_intervals(sum, points, 0.9);
      for (std::size_t i = 0; i < m.size(); ++i) {
        const double truth = c.truth(static_cast<double>(m[i]));
        inside[i] += truth >= intervals[i].lower_radps && truth <= intervals[i].upper_radps;
      }
    }
    // Three standard errors of 400 trials at 0.9 are 0.045; the tables' own approximation costs a little
    // more.
    for (std::size_t i = 0; i < m.size(); ++i)
      EXPECT_NEAR(inside[i] / double{kRecords}, 0.9, 0.06) << "m " << m[i] << " levels N " << c.levels.N;
  }
}

}  // namespace
