// SPDX-License-Identifier: Apache-2.0
// Named effects measured on white noise, against ordinary least squares written out; and what is asked for
// that is not there.
#include <Eigen/Dense>

#include "filters/diagnosis/measure.h"
#include "filters/model_file/form.h"
#include "tests/unit/diagnosis/made_capture.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr std::size_t kSamples = 3000;
constexpr double kNoise = 1e-6, kPerDegree = 2e-8, kPerVolt = 3e-7;

struct Sensor {
  std::vector<double> time_s, rate, temperature, supply, still;
  explicit Sensor(std::uint64_t seed) {
    test::Noise normal(seed);
    for (std::size_t i = 0; i < kSamples; ++i) {
      const double t = static_cast<double>(i);
      time_s.push_back(t);
      temperature.push_back(30.0 + 6.0 * std::sin(2.0 * M_PI * t / 500.0));
      supply.push_back(12.0 + 0.3 * std::sin(2.0 * M_PI * t / 333.0));
      still.push_back(5.0);
      rate.push_back(4e-5 + kPerDegree * (temperature.back() - 25.0) + kPerVolt * (supply.back() - 12.0) +
                     kNoise * normal());
    }
  }
  [[nodiscard]] Record record() const {
    return made_record("sensor", time_s, rate,
                       {{"temperature_degC", temperature}, {"supply_V", supply}, {"still_V", still}});
  }
};

Effect linear_in(const std::string& channel) {
  Effect effect;
  effect.form = "linear";
  effect.channel = channel;
  effect.parameters = {{"coefficient", 0.0, 0.0, ""}};
  return effect;
}

struct LeastSquares {
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;
  double square = 0.0;
};

LeastSquares least_squares(const Sensor& sensor, const std::vector<const std::vector<double>*>& channels) {
  const auto n = static_cast<Eigen::Index>(kSamples);
  const auto p = static_cast<Eigen::Index>(channels.size()) + 1;
  Eigen::MatrixXd columns = Eigen::MatrixXd::Ones(n, p);
  Eigen::VectorXd rate(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    rate[i] = sensor.rate[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 1; j < p; ++j)
      columns(i, j) = (*channels[static_cast<std::size_t>(j - 1)])[static_cast<std::size_t>(i)];
  }
  LeastSquares fit;
  fit.values = columns.householderQr().solve(rate);
  fit.square = (rate - columns * fit.values).squaredNorm();
  fit.covariance = fit.square / static_cast<double>(n - p) * (columns.transpose() * columns).inverse();
  return fit;
}

// The supply is logged 40 s before it acts, which the sensor's own model says. The coefficient is that of the
// supply as it acts.
TEST(Measure, AnEarlyChannelIsWaitedFor) {
  constexpr std::size_t kEarly = 40;
  constexpr double kCoefficient = 30.0 * kPerVolt;  // a hundred times its error
  Sensor sensor(4);
  for (std::size_t i = 0; i < kSamples; ++i)
    sensor.rate[i] += (kCoefficient - kPerVolt) * (sensor.supply[i] - 12.0);
  std::vector<double> ahead(sensor.supply.begin() + kEarly, sensor.supply.end());
  ahead.insert(ahead.end(), kEarly, sensor.supply.back());
  Record logged = sensor.record();
  logged.channels[1].values = ahead;
  EffectsToMeasure wanted;
  wanted.together = {linear_in("temperature_degC"), linear_in("supply_V")};
  const auto supply = [&] {
    const MeasuredEffects found = measure_effects({logged}, wanted, "z");
    EXPECT_EQ(found.ranges.size(), 2U);
    EXPECT_EQ(found.ranges.back().channel, "supply_V");
    EXPECT_EQ(found.ranges.back().early_s, wanted.ranges.empty() ? 0.0 : wanted.ranges.front().early_s);
    return found.together[1].effect.parameters.front();
  };
  EXPECT_GT(std::abs(supply().value - kCoefficient), 0.2 * kCoefficient);
  wanted.ranges = {{"supply_V", 11.7, 12.3, static_cast<double>(kEarly)}};
  const ModelParameter waited = supply();
  EXPECT_NEAR(waited.value, kCoefficient, 3.0 * waited.std_error);
  EXPECT_LT(waited.std_error, 0.05 * kCoefficient);
}

TEST(Measure, InWhiteNoiseItIsLeastSquares) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Sensor sensor(seed);
    EffectsToMeasure wanted;
    wanted.together = {linear_in("temperature_degC")};
    wanted.others = {linear_in("supply_V")};
    const MeasuredEffects found = measure_effects({sensor.record()}, wanted, "");
    const LeastSquares both = least_squares(sensor, {&sensor.temperature, &sensor.supply});
    const LeastSquares without = least_squares(sensor, {&sensor.supply});
    ASSERT_EQ(found.together.size(), 1U);
    ASSERT_EQ(found.others.size(), 1U);
    ASSERT_TRUE(found.together[0].not_measured.empty());
    const ModelParameter& coefficient = found.together[0].effect.parameters.front();
    const double error = std::sqrt(both.covariance(1, 1));
    EXPECT_NEAR(coefficient.value, both.values[1], 0.15 * error);
    // The noise's slow part is not known to be zero, so the error is a little more.
    EXPECT_GT(coefficient.std_error, 0.98 * error);
    EXPECT_LT(coefficient.std_error, 1.3 * error);
    EXPECT_NEAR(found.others[0].parameters.front().value, both.values[2],
                0.15 * std::sqrt(both.covariance(2, 2)));
    const double ratio = static_cast<double>(kSamples) * std::log(without.square / both.square);
    EXPECT_LT(found.together[0].likelihood_ratio, 1.02 * ratio);
    EXPECT_GT(found.together[0].likelihood_ratio, 0.5 * ratio);  // without it, slow noise explains a part
    const double mean = std::accumulate(sensor.temperature.begin(), sensor.temperature.end(), 0.0) /
                        static_cast<double>(kSamples);
    EXPECT_NEAR(found.means.at(0), mean - 25.0, 1e-3);
    ASSERT_EQ(found.covariance.size(), 4U);
    EXPECT_NEAR(found.covariance[0], coefficient.std_error * coefficient.std_error,
                1e-6 * found.covariance[0]);
  }
}

// A scale factor that follows a coil which lags its thermometer by 100 s of the temperature's 500.
TEST(Measure, AProductIsMeasuredWithItsOwnLag) {
  Sensor sensor(4);
  constexpr double kScale = 1e-3, kLag_s = 100.0;
  std::vector<double> reference;
  double coil = sensor.temperature.front();
  for (std::size_t i = 0; i < kSamples; ++i) {
    if (i > 0) coil += (1.0 - std::exp(-1.0 / kLag_s)) * (sensor.temperature[i] - coil);
    reference.push_back(0.02 * std::sin(2.0 * M_PI * sensor.time_s[i] / 170.0));
    sensor.rate[i] += reference[i] * (1.0 + kScale * (coil - 25.0));
  }
  Record record = sensor.record();
  record.reference_radps = reference;
  Effect effect;
  effect.form = "product";
  effect.channel = "reference_rate_radps";
  effect.with_form = "lagged";
  effect.with_channel = "temperature_degC";
  effect.parameters = {{"coefficient", 0.0, 0.0, ""}};
  effect.parameters.push_back({std::string(time_constant_name(effect)), kLag_s, 0.0, "s"});
  EffectsToMeasure wanted;
  wanted.together = {effect};
  wanted.others = {linear_in("temperature_degC"), linear_in("supply_V"), linear_in("reference_rate_radps")};
  const MeasuredEffects found = measure_effects({record}, wanted, "");
  ASSERT_TRUE(found.together[0].not_measured.empty()) << found.together[0].not_measured;
  const ModelParameter& coefficient = found.together[0].effect.parameters.front();
  EXPECT_LT(coefficient.std_error, 0.02 * kScale);
  EXPECT_NEAR(coefficient.value, kScale, 4.0 * coefficient.std_error);
}

TEST(Measure, AnEffectThatIsNotThereIsMeasuredAsNone) {
  int far = 0;
  for (std::uint64_t seed = 10; seed < 22; ++seed) {
    Sensor sensor(seed);
    for (std::size_t i = 0; i < kSamples; ++i) sensor.rate[i] -= kPerDegree * (sensor.temperature[i] - 25.0);
    EffectsToMeasure wanted;
    wanted.together = {linear_in("temperature_degC")};
    wanted.others = {linear_in("supply_V")};
    const MeasuredEffects found = measure_effects({sensor.record()}, wanted, "");
    const ModelParameter& coefficient = found.together[0].effect.parameters.front();
    far += std::abs(coefficient.value) > 2.5758 * coefficient.std_error ? 1 : 0;
  }
  EXPECT_LE(far, 1);
}

TEST(Measure, WhatIsFittedAlongKeepsItsName) {
  const Sensor sensor(6);
  EffectsToMeasure wanted;
  wanted.together = {linear_in("temperature_degC")};
  wanted.others = {linear_in("supply_V")};
  wanted.others[0].form = "earth_rate";
  const MeasuredEffects found = measure_effects({sensor.record()}, wanted, "");
  ASSERT_EQ(found.others.size(), 1U);
  EXPECT_EQ(found.others[0].form, "earth_rate");
  EXPECT_FALSE(found.others[0].shown_only);
}

// Online the measured rate stands for the true one, and it is the true one plus the bias.
TEST(Measure, WhatDependsOnTheRateCountsFromTheBias) {
  constexpr double kBias = 3e-3, kScale = 5e-3;
  Sensor sensor(7);
  std::vector<double> truth;
  for (std::size_t i = 0; i < kSamples; ++i) {
    truth.push_back(0.2 * std::sin(2.0 * M_PI * static_cast<double>(i) / 400.0) + 0.05);
    sensor.rate[i] += truth.back() + kScale * truth.back() + kBias - 4e-5;
  }
  Record record = sensor.record();
  record.reference_radps = truth;
  EffectsToMeasure wanted;
  wanted.together = {linear_in("reference_rate_radps")};
  wanted.others = {linear_in("temperature_degC"), linear_in("supply_V")};
  const MeasuredEffects found = measure_effects({record}, wanted, "");
  ASSERT_TRUE(found.together[0].not_measured.empty());
  const Effect& effect = found.together[0].effect;
  EXPECT_NEAR(effect.parameters.front().value, kScale, 1e-4 * kScale);
  EXPECT_NEAR(effect.reference, kBias, 1e-3 * kBias);  // its error: some 1e-6 / sqrt(3000)
  ASSERT_EQ(found.others.size(), 2U);
  EXPECT_EQ(found.others[0].reference, 25.0);
}

TEST(Measure, TheRightOneOfTwoExplainsMore) {
  const Sensor sensor(4);
  EffectsToMeasure wanted;
  wanted.together = {linear_in("supply_V")};
  wanted.instead = {{linear_in("temperature_degC"), linear_in("absent_V")}};
  const MeasuredEffects found = measure_effects({sensor.record()}, wanted, "z");
  ASSERT_EQ(found.together[0].instead.size(), 2U);
  EXPECT_GT(found.together[0].instead[0], 0.0);
  EXPECT_EQ(found.together[0].instead[1], 0.0);
  EXPECT_EQ(found.together[0].effect.axis, "z");
}

TEST(Measure, WhatCannotBeMeasuredSaysWhy) {
  const Sensor sensor(1);
  EffectsToMeasure wanted;
  wanted.together = {linear_in("absent_V"), linear_in("still_V"), linear_in("temperature_degC")};
  Effect noise;
  noise.form = "outliers";
  wanted.together.push_back(noise);
  const MeasuredEffects found = measure_effects({sensor.record()}, wanted, "");
  EXPECT_EQ(found.together[0].not_measured, "the captures have no absent_V");
  EXPECT_NE(found.together[1].not_measured, "");
  EXPECT_EQ(found.together[2].not_measured, "");
  EXPECT_NE(found.together[3].not_measured, "");
  ASSERT_EQ(found.covariance.size(), 1U);
  EXPECT_EQ(found.ranges.size(), 1U);
  wanted.together = {linear_in("temperature_degC"), linear_in("temperature_degC")};
  EXPECT_THROW((void)measure_effects({sensor.record()}, wanted, ""), std::invalid_argument);
}

}  // namespace
}  // namespace ifog
