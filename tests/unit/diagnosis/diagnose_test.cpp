// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/diagnose.h"
#include "filters/diagnosis/report/prediction.h"
#include "tests/unit/diagnosis/made_capture.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

double gaussian(std::uint32_t counter, std::uint32_t stream, std::uint32_t seed) {
  return gaussian_deviate(counter, stream, seed, 5);
}

struct Sensor {
  std::vector<double> time, rate, temperature, supply;
  [[nodiscard]] Record record() const {
    return made_record("sensor", time, rate, {{"temperature_degC", temperature}, {"supply_V", supply}});
  }
};

// White noise and a random walk, a temperature that swings, a supply that wanders: and no effect yet.
Sensor quiet(std::uint32_t seed) {
  Sensor s;
  double walk = 0.0;
  double supply = 0.0;
  for (std::uint32_t i = 0; i < 15000; ++i) {
    const double t = 0.1 * i;
    walk += 3e-10 * gaussian(i, 1, seed);
    supply += 1e-3 * gaussian(i, 2, seed) - 1e-3 * supply;
    s.time.push_back(t);
    s.rate.push_back(3e-5 + 1e-6 * gaussian(i, 3, seed) + walk);
    s.temperature.push_back(28.0 + 6.0 * std::sin(2.0 * M_PI * t / 900.0) + t / 300.0 +
                            0.01 * gaussian(i, 4, seed));
    s.supply.push_back(12.0 + supply + 0.002 * gaussian(i, 5, seed));
  }
  return s;
}

TEST(Diagnose, QuietSensorsHaveNoEffect) {
  int false_alarms = 0;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    false_alarms += !diagnose({quiet(seed).record()}, {}).effects.empty();
  }
  EXPECT_EQ(false_alarms, 0);
}

// A coil behind a housing: two time constants in a row.
TEST(Diagnose, ALagOfTwoTimeConstants) {
  Sensor s = quiet(29);
  double housing = s.temperature[0];
  double coil = housing;
  for (std::size_t i = 0; i < s.rate.size(); ++i) {
    housing += (1.0 - std::exp(-0.1 / 60.0)) * (s.temperature[i] - housing);
    coil += (1.0 - std::exp(-0.1 / 150.0)) * (housing - coil);
    s.rate[i] += 1e-6 * (coil - 25.0);
  }
  const Diagnosis d = diagnose({s.record()}, {});
  ASSERT_EQ(d.effects.size(), 1U);
  EXPECT_EQ(d.effects[0].effect.form, "lagged");
  double sum = 0.0;  // the sum of both is the delay, which is what the data say best
  for (const ModelParameter& p : d.effects[0].effect.parameters) {
    if (p.name == "lag_s" || p.name == "second_lag_s") sum += p.value;
  }
  EXPECT_EQ(d.effects[0].effect.parameters.size(), 3U);
  EXPECT_NEAR(sum, 210.0, 15.0);
}

// A MEMS gyro that was off for three minutes and came back with another bias and colder (an MPU6050, sunsided/sensor-fusion):
// nothing tells the jump from the temperature, and of a gyro that was only colder the jump alone is left.
TEST(Diagnose, AJumpExplainsWhatAChannelThatChangedOnceDoes) {
  const auto has_step = [](const Diagnosis& d) {
    return std::ranges::any_of(d.indistinguishable, [](const Indistinguishable& each) {
      return each.effects[1].form == "step" && each.separate_by.find("not only at 9") != std::string::npos;
    });
  };
  for (const bool colder : {true, false}) {
    Sensor s = quiet(31);
    for (std::size_t i = 0; i < s.rate.size(); ++i) {
      const bool after = i >= 7500;
      s.time[i] += after ? 200.0 : 0.0;
      s.rate[i] += after ? 1e-6 : 0.0;
      s.temperature[i] = 25.0 - (after && colder ? 4.0 : 0.0) + 0.3 * (s.supply[i] - 12.0) +
                         0.05 * gaussian(static_cast<std::uint32_t>(i), 6, 31);
    }
    const Diagnosis d = diagnose({s.record()}, {});
    ASSERT_EQ(d.effects.size(), 1U) << colder;
    EXPECT_EQ(d.effects[0].effect.form, colder ? "linear" : "step");
    EXPECT_EQ(has_step(d), colder);
  }
  Sensor swings = quiet(32);
  for (std::size_t i = 0; i < swings.rate.size(); ++i)
    swings.rate[i] += 3e-7 * (swings.temperature[i] - 25.0);
  const Diagnosis d = diagnose({swings.record()}, {});
  ASSERT_EQ(d.effects.size(), 1U);
  EXPECT_EQ(d.effects[0].effect.channel, "temperature_degC");
  EXPECT_FALSE(has_step(d));
}

// Hysteresis: said to be one, not corrected, and counted into the heading that is promised.
TEST(Diagnose, NamesALoopAndLeavesItAlone) {
  Sensor s = quiet(31);
  double play = s.temperature[0];
  for (std::size_t i = 0; i < s.rate.size(); ++i) {
    play = std::clamp(play, s.temperature[i] - 2.5, s.temperature[i] + 2.5);
    s.rate[i] += 4e-7 * (play - s.temperature[i]);
  }
  const Diagnosis d = diagnose({s.record()}, {});
  ASSERT_TRUE(d.hysteresis);
  EXPECT_EQ(d.hysteresis->channel, "temperature_degC");
  EXPECT_NEAR(d.hysteresis->half_width, 2.5, 0.8);
  EXPECT_EQ(d.unexplained.kind, "hysteresis");
  EXPECT_TRUE(d.effects.empty());
  // Angle of the loop over its own longest run, against the noise's alone.
  const double with_loop = predict_heading(d, s.record(), 150.0, {600.0}).sigma_rad[0];
  Diagnosis without = d;
  without.hysteresis.reset();
  // Nobody knows the next capture's rate yet: a placeholder will do.
  const std::vector<double> unknown(s.rate.size(), 0.0);
  Record next = s.record();
  next.rate_radps = unknown;
  EXPECT_DOUBLE_EQ(predict_heading(d, next, 150.0, {600.0}).sigma_rad[0], with_loop);
  EXPECT_GT(with_loop, 3.0 * predict_heading(without, s.record(), 150.0, {600.0}).sigma_rad[0]);
}

// A Shupe effect next to a thermometer of 1/16 K and some hundredths of noise at the gyro's rate: its readings need to be
// smoothed over longer than the coil's own time constant, which would multiply their noise.
TEST(Diagnose, ARateIsSmoothedAsItsThermometerNeeds) {
  Sensor s = quiet(33);
  double before = s.temperature[0];
  for (std::size_t i = 0; i < s.rate.size(); ++i) {
    double& temperature = s.temperature[i];
    temperature = 28.0 + 6.0 * std::sin(2.0 * M_PI * s.time[i] / 900.0);
    s.rate[i] += 2e-4 * (temperature - std::exchange(before, temperature)) / 0.1;
    const double noise = 0.03 * gaussian(static_cast<std::uint32_t>(i), 6, 33);
    temperature = std::round(16.0 * (temperature + noise)) / 16.0;
  }
  const Diagnosis d = diagnose({s.record()}, {});
  ASSERT_EQ(d.effects.size(), 1U);
  EXPECT_EQ(d.effects[0].effect.form, "rate");
  EXPECT_GT(parameter(d.effects[0].effect, "bandwidth_s"), 3.0);
  EXPECT_LT(d.after.at("rms_10s_radps"), 0.4 * d.before.at("rms_10s_radps"));
  EXPECT_LT(d.after.at("residual_rms_radps"), d.before.at("residual_rms_radps"));
}

// A loop is the play less its channel, so an effect of the channel is of the whole error: what least squares finds without
// the loop.
TEST(Diagnose, ACoefficientNextToALoopIsThatOfTheWholeError) {
  constexpr double kCoefficient = 3e-7, kLoop = 4e-7;
  Sensor s = quiet(31);
  double play = s.temperature[0];
  for (std::size_t i = 0; i < s.rate.size(); ++i) {
    play = std::clamp(play, s.temperature[i] - 2.5, s.temperature[i] + 2.5);
    s.rate[i] += kCoefficient * s.temperature[i] + kLoop * (play - s.temperature[i]);
  }
  double mean = 0.0, product = 0.0, square = 0.0;
  for (const double each : s.temperature) mean += each / static_cast<double>(s.temperature.size());
  for (std::size_t i = 0; i < s.rate.size(); ++i) {
    const double off = s.temperature[i] - mean;
    product += off * s.rate[i];
    square += off * off;
  }
  const Diagnosis d = diagnose({s.record()}, {});
  ASSERT_TRUE(d.hysteresis);
  ASSERT_EQ(d.effects.size(), 1U);
  EXPECT_NEAR(parameter(d.effects[0].effect, "coefficient"), product / square, 0.1 * product / square);
}

TEST(Diagnose, SeveralRecordsHaveASwitchOnBiasEach) {
  Sensor a = quiet(25);
  Sensor b = quiet(26);
  for (double& rate : b.rate) rate += 5e-6;
  EXPECT_TRUE(diagnose({a.record(), b.record()}, {}).effects.empty());
}

// White noise has the Allan deviation of its mean, with a gap as without.
TEST(Diagnose, AGapIsNeitherQuietNorAChangeOfTheNoise) {
  Sensor s = quiet(28);
  for (std::size_t i = 0; i < s.time.size(); ++i) {
    s.rate[i] = 1e-6 * gaussian(static_cast<std::uint32_t>(i), 3, 28);
    if (i >= 7500) s.time[i] += 3000.0;
  }
  const Diagnosis found = diagnose({s.record()}, {});
  EXPECT_NEAR(found.before.at("adev_1s_radps"), 1e-6 / std::sqrt(10.0), 0.03e-6);
  EXPECT_NE(found.unexplained.kind, "changing_variance");
}

TEST(Diagnose, NamesTheChannelsItCannotUse) {
  const Sensor a = quiet(25);
  const Sensor b = quiet(26);
  const std::vector<double> constant(a.rate.size(), 1.0);
  const std::vector<double> empty(a.rate.size(), std::nan(""));
  Record first = a.record();
  first.channels.push_back({"pressure_hPa", constant});
  first.channels.push_back({"light_W", empty});
  Record second = b.record();
  second.channels = {second.channels[0], {"pressure_hPa", constant}, {"light_W", empty}};
  const Diagnosis d = diagnose({first, second}, {});
  ASSERT_FALSE(d.remarks.empty());
  EXPECT_EQ(d.remarks[0],
            "channels that say nothing here and were dropped: pressure_hPa (never changing); "
            "supply_V (not in every capture); light_W (without a value)");
}

TEST(Diagnose, RefusesWhatItCannotUse) {
  EXPECT_THROW(diagnose({}, {}), std::invalid_argument);
  Sensor s = quiet(27);
  DiagnoseOptions backwards;
  backwards.fit_from = 0.6;
  backwards.fit_to = 0.5;
  EXPECT_THROW(diagnose({s.record()}, backwards), std::invalid_argument);
  Record r = s.record();
  r.reference_radps = s.temperature;
  EXPECT_THROW(diagnose({s.record(), r}, {}), std::invalid_argument);
  const std::vector<double> still(s.rate.size(), 3e-5);
  r = s.record();
  r.rate_radps = still;
  EXPECT_THROW(diagnose({r}, {}), std::invalid_argument);
  r = s.record();
  r.rate_radps = r.rate_radps.subspan(1);
  EXPECT_THROW(diagnose({r}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace ifog
