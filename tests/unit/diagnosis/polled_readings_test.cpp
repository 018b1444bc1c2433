// SPDX-License-Identifier: Apache-2.0
// Channels that are held between readings, polled here at times that the test knows.
#include "filters/diagnosis/channels/polled_readings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace ifog {
namespace {

constexpr double kPeriod = 7.3, kFirst = 2.6;  // steps
constexpr std::size_t kSteps = 3000;

double slow(double at) { return 25.0 + 4.0 * std::sin(at / 90.0) + 1.5 * std::sin(at / 31.0); }

// Step i is the mean over [i, i + 1) of what was read last.
std::vector<double> held(const std::function<double(double)>& channel, double period = kPeriod) {
  std::vector<double> values;
  double next = kFirst, now = channel(kFirst - period);
  for (std::size_t i = 0; i < kSteps; ++i) {
    const auto begin = static_cast<double>(i);
    double mean = now;
    if (next < begin + 1.0) {
      const double before = now;
      now = channel(next);
      mean = (next - begin) * before + (begin + 1.0 - next) * now;
      next += period;
    }
    values.push_back(mean);
  }
  return values;
}

TEST(PolledReadings, AreFoundWhenAndAsTheyWereRead) {
  const auto found = polled_readings(held(slow));
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->period, kPeriod, 1e-9);
  ASSERT_EQ(found->readings.size(), 1U + static_cast<std::size_t>((kSteps - kFirst) / kPeriod) + 1U);
  EXPECT_EQ(found->readings[0].step, 0.0);  // what was held when the record began
  EXPECT_DOUBLE_EQ(found->readings[0].value, slow(kFirst - kPeriod));
  for (std::size_t k = 1; k < found->readings.size(); ++k) {
    const double at = kFirst + kPeriod * static_cast<double>(k - 1);
    EXPECT_NEAR(found->readings[k].step, at, 1e-6) << k;
    EXPECT_NEAR(found->readings[k].value, slow(at), 1e-9) << k;
  }
}

// Of a coarse sensor one reading in three is the same as the one before it, and a reading all the same.
TEST(PolledReadings, OneThatRepeatsTheLastIsOneToo) {
  const auto coarse = [](double at) { return std::round(4.0 * slow(at)) / 4.0; };
  const auto found = polled_readings(held(coarse));
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->period, kPeriod, 0.01);
  std::size_t repeated = 0;
  for (std::size_t k = 1; k < found->readings.size(); ++k) {
    const double at = kFirst + kPeriod * static_cast<double>(k - 1);
    EXPECT_NEAR(found->readings[k].step, at, kPeriod) << k;
    repeated += found->readings[k].value == found->readings[k - 1].value ? 1 : 0;
    EXPECT_EQ(found->readings[k].value, coarse(at)) << k;
  }
  EXPECT_GT(repeated, found->readings.size() / 10);
}

TEST(PolledReadings, ALineOverAHoleIsNotLookedInto) {
  std::vector<double> values = held(slow);
  const double from = values[1000], to = values[1200];
  for (std::size_t i = 1001; i < 1200; ++i)
    values[i] = from + (to - from) * static_cast<double>(i - 1000) / 200.0;
  const auto found = polled_readings(values);
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->period, kPeriod, 0.02);
  for (const Reading& each : found->readings) EXPECT_TRUE(each.step <= 1000.0 || each.step >= 1199.0);
}

TEST(PolledReadings, OfWhatIsNotPolledThereAreNone) {
  std::vector<double> moving, irregular;
  std::mt19937_64 random(3);
  std::uniform_int_distribution<std::size_t> pause(3, 12);
  std::size_t next = 0;
  for (std::size_t i = 0; i < kSteps; ++i) {
    moving.push_back(slow(static_cast<double>(i)));
    irregular.push_back(i == next || irregular.empty() ? slow(static_cast<double>(i)) : irregular.back());
    if (i == next) next += pause(random);
  }
  EXPECT_FALSE(polled_readings(moving).has_value());
  EXPECT_FALSE(polled_readings(irregular).has_value());
  EXPECT_FALSE(polled_readings(held([](double at) { return std::fmod(at, 200.0) < 90.0 ? 0.0 : 1.0; })));
  // Set to another level at each beat: it stays there in between.
  std::normal_distribution<double> level;
  EXPECT_FALSE(polled_readings(held([&](double) { return level(random); })));
  // Rows that are as quick as the readings, nearly.
  EXPECT_FALSE(polled_readings(held(slow, 2.4)));
}

TEST(PolledReadings, AreJoinedByLines) {
  const std::vector<Reading> readings{{10.0, 1.0}, {14.0, 3.0}, {15.0, -1.0}};
  EXPECT_EQ(on_line(readings, 3.0), 1.0);
  EXPECT_EQ(on_line(readings, 10.0), 1.0);
  EXPECT_EQ(on_line(readings, 11.0), 1.5);
  EXPECT_EQ(on_line(readings, 14.75), 0.0);
  EXPECT_EQ(on_line(readings, 99.0), -1.0);
}

}  // namespace
}  // namespace ifog
