// SPDX-License-Identifier: Apache-2.0
// Laws of a gyro that polynomials of one channel are not, made here by their equations and found: a bias that
// ages, one that turns over, a scale factor that is right at a supply nobody knows, an answer through the
// temperature. What is written is run over a second capture, whose truth is the same equation.
#include "filters/diagnosis/diagnose.h"
#include "filters/diagnosis/record/compensated_error.h"
#include "filters/model_file/form.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"
#include "tests/unit/diagnosis/findings.h"
#include "tests/unit/diagnosis/made_capture.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr double kWhite = 1e-6;
constexpr std::uint32_t kSamples = 9000;
constexpr double kStep_s = 0.2;

double gaussian(std::uint32_t counter, std::uint32_t stream) {
  return gaussian_deviate(counter, stream, 13, 9);
}

struct Capture {
  std::vector<double> time, rate, turn, temperature, supply;
  [[nodiscard]] Record record() const {
    return made_record("sensor", time, rate, {{"temperature_degC", temperature}, {"supply_V", supply}}, turn);
  }
};

// Half an hour at 5 Hz; law(time, turn, temperature, supply) is the error of the rate. warmer: by so much.
template <class Law>
Capture make(std::uint32_t stream, double noise, double warmer, bool turns, Law law) {
  Capture c;
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    const double t = kStep_s * i;
    c.time.push_back(t);
    if (turns) c.turn.push_back(0.3 * std::sin(2.0 * M_PI * t / 50.0 + stream));
    c.temperature.push_back(25.0 + warmer + 6.0 * std::sin(2.0 * M_PI * t / 700.0 + stream) +
                            0.004 * gaussian(i, stream + 50));
    c.supply.push_back(12.3 + 0.2 * std::sin(2.0 * M_PI * t / 331.0 + 2.0 * stream) +
                       0.0005 * gaussian(i, stream + 60));
    const double turn = turns ? c.turn.back() : 0.0;
    c.rate.push_back(turn + law(t, turn, c.temperature.back(), c.supply.back()) +
                     noise * gaussian(i, stream));
  }
  return c;
}

// RMS about the mean of what the written model leaves of a capture without noise, over what it was given.
double left_of(const Diagnosis& diagnosis, const Capture& next) {
  Model model;
  add_to_model(diagnosis, "", model);
  const auto about_mean = [](std::span<const double> x) {
    double mean = 0.0, square = 0.0;
    for (const double v : x) mean += v / static_cast<double>(x.size());
    for (const double v : x) square += (v - mean) * (v - mean);
    return std::sqrt(square);
  };
  return about_mean(compensated_error(next.record(), model)) /
         about_mean(compensated_error(next.record(), Model{}));
}

TEST(Laws, ABiasThatAgesIsCorrectedBySlope) {
  const auto law = [](double t, double, double, double) { return 1e-9 * t; };
  const Diagnosis found = diagnose({make(1, kWhite, 0.0, false, law).record()}, {});
  ASSERT_EQ(all_in_words(found), "rate_ramp of ; ");
  ASSERT_EQ(found.ranges.size(), 1U);
  EXPECT_EQ(found.ranges[0].channel, "time_s");
  EXPECT_NEAR(found.ranges[0].high, kStep_s * kSamples, 5.0);
  EXPECT_LT(left_of(found, make(2, 0.0, 0.0, false, law)), 0.15);
}

// Neither the bias at 12 V nor a curve is known from a record at 12.3 V: what is corrected there has mean zero,
// and is as certain there as the record makes it. About 25 degrees the correction is zero at 25.
TEST(Laws, AwayFromWhereItIsZeroACorrectionKeepsTheMean) {
  const auto law = [](double, double, double, double supply) { return 2e-5 * supply; };
  const Capture made = make(1, kWhite, 0.0, false, law);
  const Diagnosis found = diagnose({made.record()}, {});
  ASSERT_EQ(all_in_words(found), "linear of supply_V; ");
  Model model;
  add_to_model(found, "", model);
  const auto mean = [](std::span<const double> x) {
    double sum = 0.0;
    for (const double v : x) sum += v;
    return sum / static_cast<double>(x.size());
  };
  EXPECT_NEAR(mean(compensated_error(made.record(), model)), mean(made.rate), 1e-3 * kWhite);
  const double volts = mean(made.supply) - 12.0;
  ASSERT_EQ(model.covariance.size(), 4U);
  const double at_mean =
      volts * volts * model.covariance[0] + 2.0 * volts * model.covariance[1] + model.covariance[3];
  EXPECT_LT(at_mean, 1e-3 * volts * volts * model.covariance[0]);

  const auto warm = [](double, double, double temperature, double) { return 1e-6 * temperature; };
  const Capture at_home = make(1, kWhite, 2.0, false, warm);
  const Diagnosis other = diagnose({at_home.record()}, {});
  ASSERT_EQ(all_in_words(other), "linear of temperature_degC; ");
  Model of_temperature;
  add_to_model(other, "", of_temperature);
  EXPECT_NEAR(mean(compensated_error(at_home.record(), of_temperature)), 25e-6, 0.1e-6);
}

TEST(Laws, ATransitionIsFoundAndEndsAtItsLevels) {
  const auto law = [](double, double, double temperature, double) {
    return 8e-7 * std::tanh((temperature - 26.0) / 1.5);
  };
  const Diagnosis found = diagnose({make(3, kWhite, 0.0, false, law).record()}, {});
  ASSERT_EQ(all_in_words(found), "transition of temperature_degC; ");
  const Effect& effect = found.effects[0].effect;
  EXPECT_NEAR(effect.reference, 26.0, 0.2);
  EXPECT_NEAR(parameter(effect, "half_width"), 1.5, 4.0 * effect.parameters[1].std_error);
  EXPECT_NEAR(std::abs(parameter(effect, "coefficient")), 8e-7, 4.0 * effect.parameters[0].std_error);
  EXPECT_GT(effect.parameters[1].std_error, 0.0);
  EXPECT_LT(effect.parameters[1].std_error, 0.3);
  EXPECT_LT(left_of(found, make(4, 0.0, 8.0, false, law)), 0.2) << "the second capture is warmer";
}

// The turning point lies where the first capture was; a tangent at its edge would leave a third of the
// square.
TEST(Laws, AWellKnownTurningPointIsFollowedBeyondItsRange) {
  const auto law = [](double, double, double temperature, double) {
    return 6e-8 * (temperature - 24.0) * (temperature - 24.0);
  };
  const Diagnosis found = diagnose({make(8, kWhite, 0.0, false, law).record()}, {});
  const Effect* const square = effect_of(found, "quadratic", "temperature_degC");
  ASSERT_NE(square, nullptr) << all_in_words(found);
  EXPECT_NEAR(parameter(*square, "curve_reach"), 12.0, 0.2) << "as far as its range is wide";
  EXPECT_LT(left_of(found, make(9, 0.0, 9.0, false, law)), 0.15) << "the second capture is warmer";
}

// No law of the environment is a cube. A cubic that fits within the range, such as a supply below which a
// regulator drops out, is extrapolated by its tangent at most.
TEST(Laws, ACubeOfTheSurroundingsIsNotFollowedBeyondItsRange) {
  const auto law = [](double, double, double, double supply) { return 4e-5 * std::pow(supply - 12.0, 3); };
  const Diagnosis found = diagnose({make(10, kWhite, 0.0, false, law).record()}, {});
  const Effect* const cube = effect_of(found, "cubic");
  ASSERT_NE(cube, nullptr) << all_in_words(found);
  EXPECT_EQ(parameter(*cube, "curve_reach"), 0.0);
}

// At 12.3 V, the middle of what it saw, the scale factor is right: alone neither of the two shows.
TEST(Laws, AScaleFactorIsRightAtASupplyNobodyKnows) {
  const auto law = [](double, double turn, double, double supply) { return 3e-6 * turn * (supply - 12.3); };
  const Diagnosis found = diagnose({make(6, 3e-7, 0.0, true, law).record()}, {});
  EXPECT_EQ(found.effects.size(), 2U) << all_in_words(found);
  EXPECT_LT(left_of(found, make(7, 0.0, 0.0, true, law)), 0.2);
  EXPECT_TRUE(std::ranges::any_of(found.remarks, [](const std::string& said) {
    return test::has(said, "bias and scale factor are those at supply_V = 12 (here 12.1 to 12.5)");
  }));
}

TEST(Laws, AnAnswerThroughTheTemperatureNeedsNoEffectOfItsOwnFirst) {
  const auto law = [](double, double, double temperature, double supply) {
    return 4e-7 * (temperature - 25.0) * (supply - 12.3 + 0.3);
  };
  const Diagnosis found = diagnose({make(8, kWhite, 0.0, false, law).record()}, {});
  ASSERT_EQ(found.effects.size(), 1U) << all_in_words(found);
  EXPECT_EQ(found.effects[0].effect.form, "product");
  EXPECT_LT(left_of(found, make(9, 0.0, 0.0, false, law)), 0.2);
}

// A warm-up is what no channel explains, and what the start of the filter does not make by itself.

// Two hours at 1 Hz beside a thermometer; noise 1e-6 rad/s.
Diagnosis diagnosis_of(const std::function<double(double)>& temperature,
                       const std::function<double(double t, double celsius)>& error, std::uint64_t seed) {
  test::Noise normal(seed);
  std::vector<double> time, rate, celsius;
  for (int i = 0; i < 7200; ++i) {
    const double t = i;
    time.push_back(t);
    celsius.push_back(temperature(t) + 0.004 * normal());
    rate.push_back(error(t, temperature(t)) + 1e-6 * normal());
  }
  return diagnose({made_record("two hours", time, rate, {{"temperature_degC", celsius}})}, {});
}

std::vector<std::string> named(const Diagnosis& diagnosis) {
  std::vector<std::string> names;
  for (const FoundEffect& found : diagnosis.effects)
    names.push_back(found.effect.form + (found.effect.channel.empty() ? "" : " of " + found.effect.channel));
  return names;
}

// A sensor that heats itself: a bias with a turning point at 31 °C settles much as a warm-up does.
TEST(WarmUp, WhatTheTemperatureExplainsIsTheTemperatures) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Diagnosis found =
        diagnosis_of([](double t) { return 38.0 - 14.0 * std::exp(-t / 1100.0) + 0.5 * std::sin(t / 400.0); },
                     [](double, double celsius) { return 2e-8 * std::pow(celsius - 31.0, 2); }, seed);
    ASSERT_FALSE(found.effects.empty()) << seed;
    for (const std::string& name : named(found))
      EXPECT_TRUE(test::has(name, " of temperature_degC")) << seed << ' ' << name;
  }
}

// One that does not heat itself in a room of its own weather.
TEST(WarmUp, WhatNoChannelExplainsIsAWarmUp) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Diagnosis found =
        diagnosis_of([](double t) { return 22.0 + 2.0 * std::sin(t / 900.0 + 1.0) + std::sin(t / 330.0); },
                     [](double t, double) { return 1e-6 * std::exp(-t / 500.0); }, seed);
    EXPECT_EQ(named(found), std::vector<std::string>{"warm_up"}) << seed;
  }
}

// A record of 1e-6 rad/s exp(-t / 500 s) and noise of 1e-7 rad/s that begins so long after power-up.
struct Settling {
  std::vector<double> time, rate;
  explicit Settling(double on_s, std::uint64_t seed) {
    test::Noise normal(seed);
    for (int i = 0; i < 7200; ++i) {
      time.push_back(i);
      rate.push_back(1e-6 * std::exp(-(on_s + i) / 500.0) + 1e-7 * normal());
    }
  }
  [[nodiscard]] Record on_for(double on_s) const {
    Record record = made_record("settling", time, rate, {});
    record.since_power_up_s = on_s;
    return record;
  }
};

void expect_the_law(const Diagnosis& found) {
  ASSERT_EQ(named(found), std::vector<std::string>{"warm_up"});
  const std::vector<ModelParameter>& is = found.effects[0].effect.parameters;
  EXPECT_NEAR(is[0].value, 1e-6, std::min(3e-7, 5.0 * is[0].std_error));
  EXPECT_NEAR(is[1].value, 500.0, 5.0 * is[1].std_error);
}

TEST(WarmUp, ItCountsFromPowerUp) {
  const Settling late(400.0, 1), early(0.0, 2);
  expect_the_law(diagnose({late.on_for(400.0)}, {}));
  expect_the_law(diagnose({early.on_for(0.0), late.on_for(400.0)}, {}));
}

// Judged by the daemon's compensator on the whole record, whose first twentieth was not fitted.
TEST(WarmUp, TheFirstPartMayBeKeptBack) {
  DiagnoseOptions options;
  options.fit_from = 0.05;
  const Diagnosis found = diagnose({Settling(0.0, 3).on_for(0.0)}, options);
  expect_the_law(found);
  EXPECT_LT(found.after.at("rms_10s_radps"), 0.3 * found.before.at("rms_10s_radps"));
}

// After six time constants nobody knows what it was at power-up.
TEST(WarmUp, NoneIsCorrectedThatIsLongPast) {
  const Diagnosis found = diagnose({Settling(0.0, 4).on_for(3000.0)}, {});
  ASSERT_EQ(named(found), std::vector<std::string>{"warm_up"});
  EXPECT_TRUE(found.effects[0].effect.shown_only);
  EXPECT_NEAR(found.effects[0].effect.parameters[0].value, 1e-6, 1e-7);
  EXPECT_EQ(found.after.at("rms_100s_radps"), found.before.at("rms_100s_radps"));
}

}  // namespace
}  // namespace ifog
