// SPDX-License-Identifier: Apache-2.0
// Kinds of effects from the physics of the instrument, made by their laws and found by the diagnosis.
#include "filters/diagnosis/diagnose.h"
#include "filters/diagnosis/record/blocks.h"
#include "filters/diagnosis/regression/candidates.h"
#include "filters/effects/compensator.h"
#include "filters/model_file/channel_names.h"
#include "filters/model_file/form.h"
#include "tests/unit/diagnosis/findings.h"
#include "tests/unit/diagnosis/made_capture.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr double kEarth = 7.292115e-5;
constexpr double kGravity = 9.80665;
constexpr double kWhite = 1e-6;

double gaussian(std::uint32_t at, std::uint32_t stream) { return gaussian_deviate(at, stream, 77, 6); }

// Half an hour at 5 Hz of white noise and a walk; columns are added by name.
struct Sensor {
  std::vector<double> time, rate, reference, other_rate;
  std::vector<std::pair<std::string, std::vector<double>>> columns;

  explicit Sensor(std::uint32_t stream) {
    double walk = 0.0;
    for (std::uint32_t i = 0; i < 9000; ++i) {
      walk += 3e-10 * gaussian(i, stream + 100);
      time.push_back(0.2 * i);
      rate.push_back(3e-5 + kWhite * gaussian(i, stream) + walk);
    }
  }
  template <class Value>
  std::vector<double>& add(const std::string& name, Value value) {
    std::vector<double> values;
    for (const double t : time) values.push_back(value(t));
    return columns.emplace_back(name, std::move(values)).second;
  }
  template <class Value>
  void turn(Value value) {
    for (std::size_t i = 0; i < time.size(); ++i) {
      reference.push_back(value(time[i]));
      rate[i] += reference.back();
    }
  }
  [[nodiscard]] Record record() const {
    Record r;
    r.name = "sensor";
    r.time_s = time;
    r.rate_radps = rate;
    r.reference_radps = reference;
    for (const auto& [name, values] : columns) r.channels.push_back({name, values});
    if (!other_rate.empty()) r.other_axes = {{"rate_y_radps", other_rate}};
    return r;
  }
};

// The bias against a reference, which every sensor has, is not counted.
Diagnosis diagnosed(const Record& record, const DiagnoseOptions& options = {}) {
  Diagnosis found = diagnose({record}, options);
  std::erase_if(found.effects, [](const FoundEffect& each) { return each.effect.form == "bias"; });
  return found;
}

// Within four standard errors, which are no larger than a tenth of the value.
void expect_coefficient(const Effect* effect, double value) {
  ASSERT_NE(effect, nullptr);
  const ModelParameter& found = effect->parameters[0];
  EXPECT_NEAR(found.value, value, 4.0 * found.std_error);
  EXPECT_LT(found.std_error, 0.1 * std::abs(value));
}

double tilt_at(double t) {
  return 0.06 * std::sin(2.0 * M_PI * t / 400.0) + 0.03 * std::sin(2.0 * M_PI * t / 91.0);
}

// Tilts about the level axis y: what the axis x sees of the Earth, at 48 degrees and a heading of 60.
Sensor tilting(std::uint32_t stream) {
  Sensor s(stream);
  const double latitude = 48.0 * M_PI / 180.0;
  const double heading = M_PI / 3.0;
  for (std::size_t i = 0; i < s.time.size(); ++i) {
    const double tilt = tilt_at(s.time[i]);
    s.rate[i] += kEarth * (std::cos(latitude) * std::cos(heading) * std::cos(tilt) +
                           std::sin(latitude) * std::sin(tilt));
  }
  s.add("accel_x_mps2", [](double t) { return kGravity * std::sin(tilt_at(t)); });
  s.add("accel_z_mps2", [](double t) { return kGravity * std::cos(tilt_at(t)); });
  return s;
}

TEST(Grammar, TheEarthsRateInAGyroThatTiltsIsShownAndNotSubtracted) {
  const Sensor s = tilting(1);
  const Diagnosis shown = diagnosed(s.record());
  const double slope = kEarth * std::sin(48.0 * M_PI / 180.0) / kGravity;
  expect_coefficient(effect_of(shown, "earth_rate", "accel_x_mps2"), slope);
  for (const FoundEffect& found : shown.effects) EXPECT_TRUE(found.effect.shown_only) << found.effect.form;
  Model model;
  add_to_model(shown, "", model);
  EXPECT_TRUE(model.effects.empty());
  EXPECT_TRUE(model.covariance.empty());
  EXPECT_DOUBLE_EQ(shown.after.at("rms_10s_radps"), shown.before.at("rms_10s_radps"));
  ASSERT_FALSE(shown.indistinguishable.empty());
  EXPECT_EQ(shown.indistinguishable.back().effects[1].form, "linear");

  DiagnoseOptions asked;
  asked.subtract_earth_rate = true;
  const Diagnosis subtracted = diagnose({s.record()}, asked);
  Model with;
  add_to_model(subtracted, "", with);
  ASSERT_FALSE(with.effects.empty());
  EXPECT_EQ(with.effects[0].form, "earth_rate");
  EXPECT_LT(subtracted.after.at("rms_10s_radps"), 0.3 * subtracted.before.at("rms_10s_radps"));
}

TEST(Grammar, WhatIsLargerThanTheEarthsRateIsAnEffect) {
  Sensor s(2);
  std::vector<double>& accel =
      s.add("accel_x_mps2", [](double t) { return kGravity * std::sin(tilt_at(t)); });
  for (std::size_t i = 0; i < accel.size(); ++i) s.rate[i] += 2.0 * kEarth / kGravity * accel[i];
  const Diagnosis found = diagnosed(s.record());
  expect_coefficient(effect_of(found, "linear", "accel_x_mps2"), 2.0 * kEarth / kGravity);
  EXPECT_TRUE(found.indistinguishable.empty() || found.indistinguishable.back().effects[1].form != "linear");
}

// Along the poles' latitude the horizontal part is nothing: an accelerometer across the axis can see none of
// it.
TEST(Grammar, AKnownLatitudeBoundsTheEarthsRate) {
  Sensor s(3);
  std::vector<double>& accel =
      s.add("accel_y_mps2", [](double t) { return kGravity * std::sin(tilt_at(t)); });
  for (std::size_t i = 0; i < accel.size(); ++i) s.rate[i] += 0.8 * kEarth / kGravity * accel[i];
  DiagnoseOptions options;
  options.axis = "x";
  EXPECT_NE(effect_of(diagnose({s.record()}, options), "earth_rate", "accel_y_mps2"), nullptr);
  options.latitude_rad = 80.0 * M_PI / 180.0;
  EXPECT_NE(effect_of(diagnose({s.record()}, options), "linear", "accel_y_mps2"), nullptr);
}

// A sled: the specific force grows as it is driven, which tilt never makes it do.
TEST(Grammar, AnAccelerationWithoutTiltIsGSensitivityHoweverSmall) {
  DiagnoseOptions known;
  known.allow_motion_channels = true;
  Sensor s(4);
  std::vector<double> drive;
  for (const double t : s.time) drive.push_back(2.0 * std::sin(2.0 * M_PI * t / 40.0));
  for (std::size_t i = 0; i < drive.size(); ++i) s.rate[i] += 0.3 * kEarth / kGravity * drive[i];
  s.columns.emplace_back("accel_x_mps2", drive);
  s.add("accel_y_mps2", [](double t) { return 0.01 * std::sin(t); });
  s.add("accel_z_mps2", [](double t) { return kGravity + 0.01 * std::cos(t); });
  expect_coefficient(effect_of(diagnosed(s.record(), known), "linear", "accel_x_mps2"),
                     0.3 * kEarth / kGravity);

  // Driven up and down as well, against what x alone would make the whole force change.
  for (std::size_t i = 0; i < drive.size(); ++i)
    s.columns[2].second[i] += 2.0 * std::sin(2.0 * M_PI * s.time[i] / 57.0) - 0.05 * drive[i] * drive[i];
  expect_coefficient(effect_of(diagnosed(s.record(), known), "linear", "accel_x_mps2"),
                     0.3 * kEarth / kGravity);
}

TEST(Grammar, MisalignmentIsTracedToTheOtherAxis) {
  Sensor s(5);
  s.turn([](double t) { return 0.2 * std::sin(2.0 * M_PI * t / 60.0); });
  for (std::size_t i = 0; i < s.time.size(); ++i) {
    const double y = 0.15 * (std::fmod(s.time[i], 90.0) < 45.0 ? 1.0 : -1.0);
    s.other_rate.push_back(y + kWhite * gaussian(static_cast<std::uint32_t>(i), 205));
    s.rate[i] += 2e-5 * y;
  }
  const Diagnosis found = diagnosed(s.record());
  ASSERT_EQ(found.effects.size(), 1U) << all_in_words(found);
  const Effect* effect = effect_of(found, "linear", "rate_y_radps");
  expect_coefficient(effect, 2e-5);
  EXPECT_EQ(effect->parameters[0].unit, "rad");
  EXPECT_TRUE(test::has(effect->meaning, "misalignment"));
}

TEST(Grammar, AnotherScaleFactorBackwardsIsNoParabola) {
  Sensor s(6);
  s.turn([](double t) { return 0.3 * std::sin(2.0 * M_PI * t / 50.0); });
  for (std::size_t i = 0; i < s.time.size(); ++i) s.rate[i] += 1e-5 * std::abs(s.reference[i]);
  const Diagnosis found = diagnosed(s.record());
  ASSERT_EQ(found.effects.size(), 1U) << all_in_words(found);
  expect_coefficient(effect_of(found, "absolute", "reference_rate_radps"), 1e-5);
}

TEST(Grammar, AGradientIsOneEffectOfTwoThermometers) {
  Sensor s(7);
  const auto one = [](double t) { return 20.0 + 5.0 * std::sin(2.0 * M_PI * t / 700.0); };
  const auto other = [](double t) { return 19.0 + 4.0 * std::sin(2.0 * M_PI * t / 430.0); };
  s.add("inner_degC", one);
  s.add("outer_degC", other);
  for (std::size_t i = 0; i < s.time.size(); ++i) s.rate[i] += 1e-6 * (one(s.time[i]) - other(s.time[i]));
  const Diagnosis found = diagnosed(s.record());
  ASSERT_EQ(found.effects.size(), 1U) << all_in_words(found);
  expect_coefficient(effect_of(found, "linear", difference_of("inner_degC", "outer_degC")), 1e-6);
  ASSERT_EQ(found.ranges.size(), 1U);
  EXPECT_EQ(found.ranges[0].channel, difference_of("inner_degC", "outer_degC"));
}

TEST(Grammar, ASwitchLetsATemperatureThrough) {
  Sensor s(8);
  const auto heater = [](double t) { return std::fmod(t, 170.0) < 70.0 ? 1.0 : 0.0; };
  const auto temperature = [](double t) { return -3.0 + 4.0 * std::sin(2.0 * M_PI * t / 610.0); };
  s.add("temperature_degC", temperature);
  s.add("heater_on", heater);
  s.add("supply_V", [](double t) { return 12.0 + 0.2 * std::sin(t / 33.0); });
  for (std::size_t i = 0; i < s.time.size(); ++i)
    s.rate[i] += 5e-7 * heater(s.time[i]) * (temperature(s.time[i]) + 3.0);
  const Diagnosis found = diagnosed(s.record());
  EXPECT_EQ(found.effects.size(), 2U) << all_in_words(found);
  expect_coefficient(effect_of(found, "product", "temperature_degC"), 5e-7);
  EXPECT_NE(effect_of(found, "linear", "heater_on"), nullptr);
  EXPECT_LT(found.after.at("rms_10s_radps"), 0.6 * found.before.at("rms_10s_radps"));
}

// On a table that has turned so far: once a turn, and the table's angle.
template <class Turned>
void once_a_turn(Sensor& s, Turned turned, double cosine, double sine) {
  s.turn([&](double t) { return (turned(t + 0.1) - turned(t - 0.1)) / 0.2; });
  s.add("table_rad", [&](double t) { return std::fmod(turned(t), 2.0 * M_PI); });
  for (std::size_t i = 0; i < s.time.size(); ++i)
    s.rate[i] += cosine * std::cos(turned(s.time[i])) + sine * std::sin(turned(s.time[i]));
}

TEST(Grammar, OnceATurnIsTracedToTheTablesAngle) {
  Sensor s(9);
  once_a_turn(
      s, [](double t) { return 0.2 * t + 20.0 / M_PI * std::sin(M_PI * t / 200.0); }, 4e-7, -3e-7);
  const Diagnosis found = diagnosed(s.record());
  EXPECT_EQ(found.effects.size(), 2U) << all_in_words(found);
  expect_coefficient(effect_of(found, "cosine", "table_rad"), 4e-7);
  expect_coefficient(effect_of(found, "sine", "table_rad"), -3e-7);
  EXPECT_TRUE(found.ranges.empty()) << "an angle leaves no range";
}

TEST(Grammar, ATurningPointFarFromTheReferenceIsALineAndAParabola) {
  Sensor s(10);
  const auto temperature = [](double t) { return -5.0 + 4.0 * std::sin(2.0 * M_PI * t / 610.0); };
  s.add("temperature_degC", temperature);
  for (std::size_t i = 0; i < s.time.size(); ++i)
    s.rate[i] += 3e-8 * std::pow(temperature(s.time[i]) + 5.5, 2);
  const Diagnosis found = diagnosed(s.record());
  EXPECT_EQ(found.effects.size(), 2U) << all_in_words(found);
  expect_coefficient(effect_of(found, "quadratic", "temperature_degC"), 3e-8);
}

// The coil makes the scale factor, three minutes behind its thermometer.
TEST(Grammar, AScaleFactorOverTheCoilsTemperatureLags) {
  Sensor s(31);
  s.turn([](double t) { return 0.3 * std::sin(2.0 * M_PI * t / 50.0); });
  std::vector<double>& read =
      s.add("temperature_degC", [](double t) { return 25.0 + 8.0 * std::sin(2.0 * M_PI * t / 700.0); });
  double coil = read.front();
  for (std::size_t i = 0; i < read.size(); ++i) {
    coil += (1.0 - std::exp(-0.2 / 180.0)) * (read[i] - coil);
    s.rate[i] += 3e-6 * (coil - 25.0) * s.reference[i];
  }
  const Diagnosis found = diagnosed(s.record());
  ASSERT_EQ(found.effects.size(), 1U) << all_in_words(found);
  const Effect& effect = found.effects[0].effect;
  EXPECT_EQ(effect.form, "product");
  EXPECT_EQ(effect.with_form, "lagged");
  EXPECT_EQ(effect.with_channel, "temperature_degC");
  EXPECT_NEAR(parameter(effect, "lag_s"), 180.0, 18.0);
  EXPECT_TRUE(test::has(effect.meaning, "coil"));
  // What is written takes it away.
  EXPECT_LT(found.after.at("rms_10s_radps"), 0.3 * found.before.at("rms_10s_radps"));
}

// Never the same sample of a swing in the zone.
double swing(double t) { return 0.02 * std::sin(2.0 * M_PI * t / 37.31); }

TEST(Grammar, SlowRotationThatIsNotSeenIsADeadZone) {
  for (const double half_width : {3e-4, 5e-3}) {
    Sensor s(33);
    s.turn(swing);
    for (std::size_t i = 0; i < s.time.size(); ++i)
      if (std::abs(s.reference[i]) < half_width) s.rate[i] -= s.reference[i];
    const Diagnosis found = diagnosed(s.record());
    ASSERT_EQ(found.effects.size(), 1U) << all_in_words(found);
    const Effect* zone = effect_of(found, "dead_zone", "reference_rate_radps");
    expect_coefficient(zone, -1.0);
    // Rates within 2 % of the edge are passed by once or twice in the record.
    EXPECT_NEAR(parameter(*zone, "half_width"), half_width, 0.05 * half_width);
    EXPECT_DOUBLE_EQ(found.after.at("rms_10s_radps"), found.before.at("rms_10s_radps"));
  }
}

// At rest the error is less what the reference's own noise is: as if rotation as small as that were not seen.
TEST(Grammar, TheNoiseOfAReferenceIsNoDeadZone) {
  Sensor s(34);
  s.turn([](double t) { return std::fmod(t, 100.0) < 70.0 ? 0.0 : swing(t); });
  for (std::size_t i = 0; i < s.time.size(); ++i)
    s.reference[i] += 0.2 * kWhite * gaussian(static_cast<std::uint32_t>(i), 340);
  const Diagnosis found = diagnosed(s.record());
  EXPECT_TRUE(found.effects.empty()) << all_in_words(found);
}

// One passage is a knock.
TEST(Grammar, OnePassageMakesNoDeadZone) {
  Sensor s(35);
  s.turn(swing);
  for (std::size_t i = 2000; i < 2060; ++i)
    if (std::abs(s.reference[i]) < 3e-4) s.rate[i] -= s.reference[i];
  EXPECT_EQ(effect_of(diagnosed(s.record()), "dead_zone", "reference_rate_radps"), nullptr);
}

}  // namespace
}  // namespace ifog
