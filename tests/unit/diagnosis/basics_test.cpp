// SPDX-License-Identifier: Apache-2.0
// What comes first: bias and scale factor against a reference, noisy or of few points; rotation that stays in
// the rate; coefficients that no gyro has. The truth is what the captures are made of.
#include "filters/diagnosis/channels/motion.h"
#include "filters/diagnosis/diagnose.h"
#include "filters/diagnosis/record/blocks.h"
#include "filters/effects/meaning.h"
#include "filters/model_file/form.h"
#include "tests/unit/diagnosis/findings.h"
#include "tests/unit/diagnosis/made_capture.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

struct Rows {
  std::vector<double> time, rate, reference, channel;
  std::string name = "temperature_degC";

  [[nodiscard]] Record record() const {
    std::vector<RecordChannel> channels;
    if (!channel.empty()) channels.push_back({name, channel});
    return made_record("rows", time, rate, channels, reference);
  }
};

// A GNSS receiver or an odometer is read once a second and held until then: between its readings the reference is not of
// its time. The error bar holds: three of them.
TEST(Basics, AReferenceThatIsHeldIsUsedAtItsReadings) {
  constexpr double kScale = 3e-3;
  test::Noise normal(21);
  Rows rows;
  double slow = 0.0, truth = 0.0;
  for (int i = 0; i < 60'000; ++i) {
    slow += 0.02 * (2.0 * normal() - slow);
    truth += 0.02 * (slow - truth);
    rows.time.push_back(0.1 * i);
    rows.reference.push_back(i % 10 == 0 ? truth : rows.reference.back());
    rows.rate.push_back((1.0 + kScale) * truth + 7e-4 * normal());
  }
  const Diagnosis found = diagnose({rows.record()}, {});
  const Effect* scale = effect_of(found, "linear");
  ASSERT_TRUE(scale);
  EXPECT_NEAR(parameter(*scale, "coefficient"), kScale, 3.0 * scale->parameters[0].std_error);
  EXPECT_LT(scale->parameters[0].std_error, 0.1 * kScale);
  EXPECT_EQ(found.effects.size(), 1U);
  EXPECT_TRUE(std::ranges::any_of(found.remarks, [](const std::string& said) {
    return test::has(said, "is read in every 10 samples and held");
  }));
}

// A thermometer that is logged every ten seconds in tenths of a degree, next to an effect of the temperature and of its
// rate (Shupe): the stairs are no jumps of the bias. One in whole degrees that changes when it does is not held.
TEST(Basics, StairsOfAThermometerAreNoEffects) {
  for (const double digit : {0.1, 1.0}) {
    test::Noise normal(22);
    Rows rows;
    double oven = 25.0, air = 25.0, housing = 25.0, coil = 25.0, before = 25.0;
    for (int i = 0; i < 60'000; ++i) {
      if (i % 8'000 == 0) oven = 15.0 + 30.0 * std::abs(std::sin(1.7 * i));
      air += 1e-3 * (oven - air);
      housing += 1e-3 * (air - housing);
      coil += 3e-3 * (housing - coil);
      const double rate = (coil - std::exchange(before, coil)) / 0.1;
      rows.time.push_back(0.1 * i);
      const bool read = digit == 1.0 || i % 100 == 0;
      rows.channel.push_back(read ? digit * std::round(housing / digit) : rows.channel.back());
      rows.rate.push_back(1e-4 * (housing - 25.0) + 2e-2 * rate + 3e-4 * normal());
    }
    const Diagnosis found = diagnose({rows.record()}, {});
    EXPECT_EQ(effect_of(found, "step"), nullptr) << digit;
    const double left = found.after.at("rms_10s_radps") / found.before.at("rms_10s_radps");
    EXPECT_LT(left, digit == 0.1 ? 0.2 : 0.7) << digit;
    EXPECT_EQ(std::ranges::any_of(found.remarks,
                                  [](const std::string& said) { return test::has(said, "and held"); }),
              digit == 0.1);
  }
}

// Motion up to some hertz and a reference differentiated from noisy angles. Least squares of means of a second is
// the oracle.
TEST(Basics, AreFoundInBroadbandMotion) {
  for (const double error : {0.0, -0.01, -0.14, -2.0}) {
    test::Noise normal(11);
    Rows rows;
    double slow = 0.0, truth = 0.0, before = 0.0;
    for (int i = 0; i < 30000; ++i) {
      slow += 0.05 * (8.0 * normal() - slow);
      truth += 0.05 * (slow - truth);
      const double angle = 4e-4 * normal();
      rows.time.push_back(0.005 * i);
      rows.reference.push_back(truth + (angle - std::exchange(before, angle)) / 0.005);
      rows.rate.push_back((1.0 + error) * truth + 8e-3 + 5e-3 * normal());
    }
    double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, n = 0.0;
    for (std::size_t i = 0; i < rows.time.size(); i += 200, n += 1.0) {
      double of_reference = 0.0, of_error = 0.0;
      for (std::size_t k = i; k < i + 200; ++k) {
        of_reference += rows.reference[k] / 200.0;
        of_error += (rows.rate[k] - rows.reference[k]) / 200.0;
      }
      x += of_reference, y += of_error, xx += of_reference * of_reference, xy += of_reference * of_error;
    }
    if (error == -2.0) {
      const std::string said = test::refusal([&] { diagnose({rows.record()}, {}); });
      EXPECT_TRUE(test::has(said, "times reference_rate_radps, expected about 1"));
      continue;
    }
    const double slope = (xy - x * y / n) / (xx - x * x / n);
    const Diagnosis found = diagnose({rows.record()}, {});
    const Effect* scale = effect_of(found, "linear");
    EXPECT_NEAR(scale ? parameter(*scale, "coefficient") : 0.0, slope, 3e-3) << error;
    ASSERT_TRUE(found.bias);
    EXPECT_NEAR(found.bias->value, (y - slope * x) / n, 3e-4) << error;
    EXPECT_LT(std::abs(found.after.at("bias_radps")), 3e-4) << error;
  }
}

// The coefficient of a temperature that hardly changed says little of the bias at 25 degC, but the mean where the
// record was is known and corrected.
TEST(Basics, AMeanFarFromTheReferenceTemperatureIsCorrected) {
  test::Noise normal(12);
  Rows rows;
  for (int i = 0; i < 20000; ++i) {
    rows.time.push_back(0.1 * i);
    rows.channel.push_back(50.0 + 1.5 * std::sin(i / 1500.0));
    rows.reference.push_back(0.0);
    rows.rate.push_back(6e-5 + 2e-6 * (rows.channel.back() - 50.0) + 2e-5 * normal());
  }
  const Diagnosis found = diagnose({rows.record()}, {});
  EXPECT_NE(effect_of(found, "linear", "temperature_degC"), nullptr);
  EXPECT_LT(std::abs(found.after.at("bias_radps")), 2e-7) << "of 6e-5";
}

// A table that stands at a rate level for 42 s each. At one of them, slower than the Earth, the sensor measures nothing.
// That one event dominates the innovations, and a scale factor that fits it is refuted by the rest of the record.
TEST(Basics, OneEventIsNoScaleFactor) {
  constexpr std::uint32_t kSlow = 14;
  for (const std::uint32_t seed : {1U, 2U, 3U, 9U, 10U}) {
    const auto level = [&](std::uint32_t k) {
      return k == kSlow ? -9.2e-5 : 0.06 * gaussian_deviate(k, 1, seed, 9);
    };
    Rows rows;
    double walk = 0.0;
    for (std::uint32_t i = 0; i < 36000; ++i) {
      const double t = 0.05 * i;
      const auto k = static_cast<std::uint32_t>(t / 42.0);
      const double u = std::min(1.0, (t - 42.0 * k) / 0.3), before = level(k > 0 ? k - 1 : 0);
      rows.time.push_back(t);
      rows.reference.push_back(before + (level(k) - before) * u * u * (3.0 - 2.0 * u));
      const bool measured = k != kSlow || std::abs(rows.reference.back()) > 9.3e-5;
      walk += 8e-10 * gaussian_deviate(i, 2, seed, 9);
      rows.rate.push_back((measured ? rows.reference.back() : 0.0) + walk +
                          2e-6 * gaussian_deviate(i, 3, seed, 9));
    }
    const Diagnosis found = diagnose({rows.record()}, {});
    EXPECT_EQ(effect_of(found, "linear"), nullptr) << all_in_words(found) << "seed " << seed;
  }
}

// Thirteen points of a calibration.
TEST(Basics, ARateTableOfAFewPointsIsAccepted) {
  test::Noise normal(5);
  Rows rows;
  for (int i = -6; i <= 6; ++i) {
    rows.time.push_back(20.0 * (i + 6));
    rows.reference.push_back(0.1 * i);
    rows.rate.push_back(0.1 * i * 1.02 + 1e-4 * normal());
  }
  const Diagnosis found = diagnose({rows.record()}, {});
  const Effect* scale = effect_of(found, "linear");
  ASSERT_NE(scale, nullptr);
  EXPECT_NEAR(parameter(*scale, "coefficient"), 0.02, 0.001);
  rows.time.resize(10), rows.rate.resize(10), rows.reference.resize(10);
  EXPECT_THROW(diagnose({rows.record()}, {}), std::invalid_argument);
}

// A swing of the sensor itself, seen by what senses motion: nothing of it is an error.
TEST(Motion, ExplainsNothingWithoutAReference) {
  for (const char* name :
       {"sea_mps", "accel_x_mps2", "mount_rad", "deck_radps", "wheel_rpm", "motor_A", "thrust_N",
        "rudder_percent", "steer_cmd", "tension_kN", "wind_mps", "brake_pressure_hPa"}) {
    test::Noise normal(7);
    Rows rows;
    rows.name = name;
    double walk = 0.0;
    for (int i = 0; i < 4000; ++i) {
      const double swing = std::sin(0.9 * i + (walk += 0.1 * normal()));
      rows.time.push_back(0.5 * i);
      rows.rate.push_back(1e-6 * normal() + 5e-6 * swing);
      rows.channel.push_back(swing + 0.02 * normal());
    }
    const Diagnosis found = diagnose({rows.record()}, {});
    for (const FoundEffect& each : found.effects) EXPECT_EQ(each.effect.channel, "") << name;
    EXPECT_TRUE(std::any_of(found.remarks.begin(), found.remarks.end(), [](const std::string& remark) {
      return remark.find("that is rotation and stays in the rate") != std::string::npos;
    })) << name;
    DiagnoseOptions knows;
    knows.allow_motion_channels = knows.allow_proxies = true;
    if (motion_of(name) != Motion::kAngle && motion_of(name) != Motion::kRate) {
      EXPECT_FALSE(diagnose({rows.record()}, knows).effects.empty()) << name;
    }
  }
}

// Broad-band noise that comes and goes over minutes; `size` of its quick part's mean square is in the rate.
Rows shaken(std::uint64_t seed, double size) {
  test::Noise normal(seed);
  Rows rows;
  rows.name = "accel_x_mps2";
  double level = 0.0, shake = 0.0, slow = 0.0, power = 0.0;
  for (int i = 0; i < 30000; ++i) {
    level += -level / 3000.0 + std::sqrt(2.0 / 3000.0) * normal();
    shake += 0.3 * (2.0 * std::exp(0.5 * level) * normal() - shake);
    slow += 0.5 * (shake - slow);
    power += ((shake - slow) * (shake - slow) - power) / 25.0;
    rows.time.push_back(0.02 * i);
    rows.channel.push_back(shake);
    rows.rate.push_back(1e-6 * normal() + size * power);
  }
  return rows;
}

// Noise whose slow and quick parts come and go together hardly shows how it depends on the frequency.
TEST(Rectification, IsFoundWhereItsBandIsHardlyKnown) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Diagnosis found = diagnose({shaken(seed, 6e-7).record()}, {});
    ASSERT_EQ(found.effects.size(), 1U) << seed;
    EXPECT_EQ(found.effects[0].effect.form, "band_power") << seed;
    EXPECT_TRUE(diagnose({shaken(seed, 0.0).record()}, {}).effects.empty()) << seed;
  }
}

// A sway of 2 s for a day, whose grid has steps of 1.3 s, and a machine for ten minutes.
TEST(Rectification, IsNotLookedForWhereASwellSwings) {
  const auto shakes = [](int samples, double period_s, double turn) {
    Rows rows;
    rows.name = "accel_x_mps2";
    for (int i = 0; i < samples; ++i) {
      rows.time.push_back(period_s * i);
      rows.rate.push_back(1e-6 * (i % 7));
      rows.channel.push_back(std::sin(turn * period_s * i));
    }
    const std::vector<Record> records{rows.record()};
    BlockData data = cut_to_blocks(records);
    static_cast<void>(mark_motion(records, data, false));
    return data.channels[0].shakes;
  };
  EXPECT_FALSE(shakes(345600, 0.25, 2.0 * M_PI / 2.0));
  EXPECT_TRUE(shakes(60000, 0.01, 2.0 * M_PI * 17.0));
}

TEST(Motion, IsToldByUnitAndName) {
  EXPECT_EQ(motion_of("accel_z_mps2"), Motion::kAcceleration);
  EXPECT_EQ(motion_of("seis_z_mps"), Motion::kVelocity);
  EXPECT_EQ(motion_of("north_um"), Motion::kPosition);
  EXPECT_EQ(motion_of("attitude_deg"), Motion::kAngle);
  for (const char* name : {"temperature_degC", "supply_V", "fan_rpm", "pump_rpm", "laser_wavelength_nm",
                           "reference_rate_radps", "seis_temperature_degC", "pressure_hPa"})
    EXPECT_EQ(motion_of(name), Motion::kNone) << name;
}

// An acceleration that drifts as the bias does, by 0.5 °/s for 1 m/s^2 where makers specify 0.005.
TEST(Proxies, AreShownAndNotWritten) {
  test::Noise normal(9);
  Rows rows;
  rows.name = "accel_x_mps2";
  for (int i = 0; i < 5000; ++i) {
    const double drift = 0.1 * std::sin(i / 400.0);
    rows.time.push_back(i);
    rows.channel.push_back(drift);
    rows.rate.push_back(1e-3 * normal() + 8.7e-3 * drift);
  }
  const Diagnosis found = diagnose({rows.record()}, {});
  const Effect* proxy = effect_of(found, "linear");
  ASSERT_NE(proxy, nullptr);
  EXPECT_TRUE(proxy->shown_only);
  Model model;
  add_to_model(found, "", model);
  EXPECT_TRUE(model.effects.empty());
  DiagnoseOptions asked;
  asked.allow_proxies = true;
  const Diagnosis written = diagnose({rows.record()}, asked);
  ASSERT_NE(effect_of(written, "linear"), nullptr);
  EXPECT_FALSE(effect_of(written, "linear")->shown_only);
}

}  // namespace
}  // namespace ifog
