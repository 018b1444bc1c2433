// SPDX-License-Identifier: Apache-2.0
#include "filters/rest/glitches.h"
#include "filters/rest/cleaned_rate.h"
#include "tests/unit/test.h"
#include "tools/simulate/noise.h"

namespace ifog {
namespace {

std::vector<double> white(std::size_t n, unsigned seed) {
  std::vector<double> out = simulate::noise({.N = 1e-5}, 1.0, n, seed);
  for (double& value : out) value += 7e-5;
  return out;
}

double time_s(std::size_t i) { return 1e-2 * static_cast<double>(i); }

Glitches glitches_in(const std::vector<double>& rate) {
  return find_glitches(rate, std::vector<Stretch>{{0, rate.size()}});
}

TEST(Glitches, ASampleThatLeapsAwayAndBackIsFound) {
  std::vector<double> rate = white(20000, 1);
  rate[12345] = 1.0;
  rate[15000] = -2e-3;
  const Glitches found = find_glitches(rate, std::vector<Stretch>{{0, 10000}, {10000, 20000}});
  EXPECT_EQ(found.count, 2U);
  EXPECT_EQ(found.first, 12345U);
  EXPECT_NEAR(found.most_times, 1e5, 3e3);
  const std::string said = in_words(found, time_s);
  EXPECT_TRUE(test::has(said, "2 samples leap away and back (the first at 123.45 s"));
  EXPECT_EQ(find_glitches(rate, std::vector<Stretch>{{0, 12000}}).count, 0U);
}

TEST(Glitches, FewAreLeftOutAndManyAreTheSensor) {
  const std::vector<double> before = white(20000, 3);
  std::vector<double> rate = before;
  // The one between two of a kind is none.
  rate[300] = rate[302] = 2.0;
  rate[16384] = -5.0;  // where a piece begins
  const Glitches found = glitches_in(rate);
  EXPECT_EQ(found.count, 3U);
  EXPECT_TRUE(test::has(in_words(found, time_s), "dropped"));
  const auto without = [&](const std::vector<double>& from) {
    std::vector<ValueFault> faults;
    return without_leaps(from, from, std::vector<Stretch>{{0, from.size()}}, time_s, faults);
  };
  const std::optional<Samples> repaired = without(rate);
  ASSERT_TRUE(repaired);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double value = (*repaired)[i];
    if (i != 300 && i != 302 && i != 16384)
      EXPECT_EQ(value, before[i]) << i;
    else
      EXPECT_DOUBLE_EQ(value, 0.5 * (before[i - 1] + before[i + 1])) << i;
  }
  EXPECT_FALSE(without(before));

  for (std::size_t i = 50; i < rate.size(); i += 100) rate[i] = 1.0;
  const Glitches many = glitches_in(rate);
  EXPECT_GT(many.count, 21U);
  EXPECT_TRUE(many.few.empty());
  EXPECT_FALSE(without(rate));
  EXPECT_TRUE(test::has(in_words(many, time_s), "take for noise"));
}

// A placeholder for some samples, full scale at a record's start (PicoQuake, car_vibration.csv): as far from the noise as
// it may be. A value that a logger repeats, or zeros of a sensor that shows none of its noise, are passed on.
TEST(Glitches, RepeatedValuesAreOut) {
  const std::vector<double> before = white(20000, 4);
  const std::vector<Glitches::Leap> all{{{5000, 5003}, -999.0},
                                        {{5000, 5020}, 65535.0},
                                        {{0, 32}, -4.36},
                                        {{5000, 7000}, 0.0},
                                        {{5000, 5050}, before[777]}};
  for (const auto& [there, value] : all) {
    const std::string name = value < 0.0 ? "leaps" : "stuck";
    const std::string first = "at " + std::to_string(there.begin / 100) + " s";
    std::vector<double> logged = before;
    std::fill_n(logged.begin() + static_cast<std::ptrdiff_t>(there.begin), there.size(), value);
    for (const bool for_figures : {true, false}) {
      Samples rate;
      rate.append(logged);
      std::vector<ValueFault> faults;
      (for_figures ? leave_out_repeats : leave_out_placeholders)(rate, time_s, faults);
      const bool stays = name == "stuck" && !for_figures;
      ASSERT_EQ(faults.size(), stays ? 0U : 1U) << value;
      for (const ValueFault& fault : faults)
        EXPECT_TRUE(fault.name == name && fault.text.find(first) != std::string::npos) << fault.text;
      for (std::size_t i = 0; i < logged.size(); ++i) {
        const double left = rate[i];
        EXPECT_TRUE(stays || i < there.begin || i >= there.end ? left == logged[i] : std::isnan(left)) << i;
      }
    }
  }
  // A sensor that says each value ten times does nothing else.
  Samples slow;
  for (const double value : white(2000, 5)) slow.append(std::vector<double>(10, value));
  std::vector<ValueFault> faults;
  leave_out_repeats(slow, time_s, faults);
  EXPECT_TRUE(faults.empty());
}

// A converter of steps as large as the noise repeats values by chance, four times as large it does hardly anything else.
TEST(Glitches, ACoarseSensorStandsStillForLongOrNot) {
  for (const double step : {1.0, 4.0}) {
    std::vector<double> logged = white(20000, 5);
    for (double& value : logged) value = step * 1e-5 * std::round(value / (step * 1e-5));
    std::fill_n(logged.begin() + 7000, 100, logged[7000]);
    Samples rate;
    rate.append(logged);
    std::vector<ValueFault> faults;
    leave_out_repeats(rate, time_s, faults);
    ASSERT_EQ(faults.size(), step < 2.0 ? 1U : 0U);
    EXPECT_EQ(std::ranges::count_if(rate, [](double value) { return std::isnan(value); }) >= 100, step < 2.0);
  }
}

// A placeholder now and then or in every third row (BonaDrone, raw_data_41.csv), each time for one sample. A single
// blow, however far, is the sensor's.
TEST(Glitches, SinglePlaceholdersAreOutHoweverOftenTheyStand) {
  for (const std::size_t times : {1UL, 2UL, 500UL, 6000UL}) {
    std::vector<double> logged = white(20000, 6);
    for (std::size_t i = 0; i < times; ++i) logged[3 * i] = -174.5;
    logged[19000] = 3.0;
    Samples rate;
    rate.append(logged);
    std::vector<ValueFault> faults;
    leave_out_repeats(rate, time_s, faults);
    ASSERT_EQ(faults.size(), times > 1 ? 1U : 0U);
    for (const ValueFault& fault : faults)
      EXPECT_TRUE(test::has(fault.text, "samples leap away and back (the first at 0 s"));
    for (const std::size_t at : {std::size_t{0}, 3 * times - 3}) EXPECT_EQ(std::isnan(rate[at]), times > 1);
    EXPECT_EQ(rate[19000], 3.0);
  }
}

// A rocket under its drogue in a log that holds each value, a foot's strikes at full scale, and heel strikes with a crest of
// two equal samples, largest or not.
TEST(Glitches, TheFarthestValueStaysWhereValuesAreHeldAndOthersNearlyAsFar) {
  std::vector<double> held, strikes = white(20000, 9), crests = white(20000, 7);
  for (const double value : white(5000, 8)) held.insert(held.end(), 4, value);
  std::fill_n(held.begin() + 4000, 4, 8.6);
  for (std::size_t i = 500; i < 19000; i += 900) strikes[i] = i % 800 == 0 ? 20.0 : 34.9;
  for (const auto& [at, crest] : {std::pair{5000U, 3.4}, std::pair{9000U, 5.0}})
    crests[at] = -1.2, crests[at + 1] = crests[at + 2] = crest, crests[at + 3] = -1.5;
  for (const std::vector<double>& logged : {held, strikes, crests})
    EXPECT_EQ(find_glitches(logged, std::vector<Stretch>{{0, 20000}}, LeapOf::kOneValue).count, 0U);
}

// What stays where it has gone is a step, what takes several samples a blow: both are rates.
TEST(Glitches, NoiseStepsAndBlowsAreNone) {
  std::vector<double> rate = white(200000, 2);
  EXPECT_EQ(glitches_in(rate).count, 0U);
  for (std::size_t i = 50000; i < 100000; ++i) rate[i] += 1.0;
  for (int k = 0; k < 40; ++k) rate[150000 + static_cast<std::size_t>(k)] += 0.01 * std::sin(0.3 * k);
  EXPECT_EQ(glitches_in(rate).count, 0U);
  EXPECT_EQ(glitches_in(std::vector<double>(1000, 1e-5)).count, 0U);
}

// A tap rings for some samples, and the first turn of a record begins at once.
TEST(Glitches, TheCrestOfABlowIsNone) {
  std::vector<double> rate = white(20000, 10);
  const std::vector<double> ring{0.020, 0.0425, -0.0119, 0.0236, 0.0121, -0.01};
  for (std::size_t i = 0; i < ring.size(); ++i) rate[5000 + i] += ring[i];
  EXPECT_EQ(glitches_in(rate).count, 0U);
  rate[9000] = 0.05;
  EXPECT_EQ(glitches_in(rate).first, 9000U);
}

// By the level between them 0.18 to 0.33 of the step; noise of half a step is resolved.
TEST(ValueFaults, NoiseBelowTheResolutionIsSaid) {
  for (const auto& [deviation, level, names] :
       std::initializer_list<std::tuple<double, double, std::vector<std::string>>>{{0.15, 0.0, {"coarse"}},
                                                                                   {0.2, 0.0, {"coarse"}},
                                                                                   {0.3, 0.5, {"coarse"}},
                                                                                   {0.5, 0.0, {}},
                                                                                   {0.5, 0.5, {}}}) {
    std::vector<double> rate = white(20000, 11);
    for (double& value : rate) value = 1e-2 * std::round(level + deviation * (value - 7e-5) / 1e-5);
    std::vector<ValueFault> faults;
    find_value_faults(rate, std::vector<Stretch>{{0, rate.size()}}, 0.01, faults);
    std::vector<std::string> found;
    for (const ValueFault& fault : faults) found.push_back(fault.name);
    EXPECT_EQ(found, names) << deviation << ' ' << level;
  }
}

// A motor that runs for a while, a sensor that is switched on halfway: the noise is another there.
TEST(Glitches, LouderNoiseIsNone) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const std::size_t loud : {100UL, 200UL, 1500UL}) {
      std::vector<double> rate = white(4000, seed);
      for (std::size_t i = 2000; i < 2000 + loud; ++i) rate[i] = 7e-5 + 40.0 * (rate[i] - 7e-5);
      EXPECT_EQ(glitches_in(rate).count, 0U) << seed << ' ' << loud;
      // One in it is found all the same.
      rate[2050] = 1.0;
      EXPECT_EQ(glitches_in(rate).count, 1U) << seed << ' ' << loud;
    }
    for (const bool first : {true, false}) {
      std::vector<double> rate = white(60000, seed);
      const auto middle = rate.begin() + 30011;
      std::fill(first ? rate.begin() : middle, first ? middle : rate.end(), 0.0);
      EXPECT_EQ(glitches_in(rate).count, 0U) << seed << ' ' << first;
    }
  }
}

// Where most neighbours are the same, up to the rounding of a number times the sensor's step.
TEST(Glitches, TheStepsOfACoarseSensorAreNone) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  for (const double step : {1e-5, 1e-6, 1.6e-6}) {
    for (const double deviation : {0.2, 0.3, 0.4}) {
      for (int record = 0; record < 100; ++record) {
        const double level = std::round(10.0 * normal(engine)) + uniform(engine);
        std::vector<double> rate(6000);
        for (double& value : rate) value = step * std::round(level + deviation * normal(engine));
        EXPECT_EQ(glitches_in(rate).count, 0U) << step << ' ' << deviation << ' ' << record;
        rate[3333] = 1.0;
        EXPECT_EQ(glitches_in(rate).count, 1U) << step << ' ' << deviation << ' ' << record;
      }
    }
  }
}

}  // namespace
}  // namespace ifog
