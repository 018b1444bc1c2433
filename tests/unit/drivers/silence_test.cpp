// SPDX-License-Identifier: Apache-2.0
// Of a device with neither counter nor clock: a hole in its line is before the sample that ends it, and what
// was held up and comes at once is none.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "daemon/sensor/facts.h"
#include "drivers/host/driver_instance.h"
#include "filters/chain/incrementer.h"
#include "tests/unit/drivers/start_time.h"

namespace ifog {
namespace {

constexpr double kPeriod_s = 0.01, kDegree = std::numbers::pi / 180.0;

class Line {
 public:
  Line(const std::string& output, double rate_degps)
      : output_(output),
        rate_degps_(rate_degps),
        driver_(make_driver("dsp3000", {{"output", output}})),
        facts_(sensor_facts(driver_.description(), 0.0, 0)),
        incrementer_(facts_) {
    come({}, 0.0);
    send("\r\n", 0.0);
  }
  // The samples of those numbers, in one portion at that time.
  void come(const std::vector<int>& numbers, double at_s) {
    std::string text;
    for (const int n : numbers) {
      const double value = output_ == "rate"          ? rate_degps_
                           : output_ == "incremental" ? rate_degps_ * kPeriod_s
                                                      : std::fmod(rate_degps_ * kPeriod_s * n, 360.0);
      char line[40];
      std::snprintf(line, sizeof line, "%11.6f  1\r\n", value);
      text += line;
    }
    if (!text.empty()) send(text, at_s);
  }
  std::vector<Increment> increments;
  [[nodiscard]] const IncrementerCounts& counts() const { return incrementer_.counts(); }

 private:
  void send(const std::string& text, double at_s) {
    driver_.decode_bytes({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()},
                         kStart_ns + std::llround(at_s * 1e9), [&](const ifog_sample& sample) {
                           Reading reading;
                           read_sample(sample, facts_.frame_channels, reading);
                           Increment increment;
                           if (incrementer_.next(reading, increment)) increments.push_back(increment);
                         });
  }

  std::string output_;
  double rate_degps_;
  DriverInstance driver_;
  SensorFacts facts_;
  Incrementer incrementer_;
};

TEST(Silence, AHoleIsBeforeTheSampleThatEndsIt) {
  for (const std::string& output :
       {std::string("integrated"), std::string("incremental"), std::string("rate")})
    for (const double hole_s : {0.3, 1.0, 3.0})
      for (const int at_once : {1, 2}) {
        SCOPED_TRACE(output + ' ' + std::to_string(hole_s) + ' ' + std::to_string(at_once));
        Line line(output, 0.5);
        const int lost = static_cast<int>(std::lround(hole_s / kPeriod_s));
        const auto portion = [&](int n) {
          std::vector<int> numbers;
          for (int k = 0; k < at_once; ++k) numbers.push_back(n + k);
          line.come(numbers, (n + at_once) * kPeriod_s);
        };
        for (int n = 0; n < 600; n += at_once) portion(n);
        for (int n = 600 + lost; n < 1200; n += at_once) portion(n);
        const Increment& end = line.increments.at(600);
        EXPECT_EQ(end.flags, kGapBefore);
        EXPECT_NEAR(end.dt_s, hole_s + kPeriod_s, 2.5 * kPeriod_s);
        const bool integrated = output == "integrated";
        // Its time is by arrivals, and those of two at once scatter by half a period.
        const double within = at_once == 1 ? 0.02 : 0.08;
        EXPECT_NEAR(end.covered_s[0], integrated ? end.dt_s : kPeriod_s, 1e-4);
        EXPECT_NEAR(end.rate_radps[0], 0.5 * kDegree, (integrated ? 0.05 : 2e-3) * 0.5 * kDegree);
        EXPECT_EQ(line.counts().gaps, 1U);
        for (std::size_t i = 601; i < line.increments.size(); ++i) {
          ASSERT_EQ(line.increments[i].flags, 0U) << i;
          ASSERT_NEAR(line.increments[i].rate_radps[0], 0.5 * kDegree, within * 0.5 * kDegree) << i;
        }
      }
}

// Half round and more may have been turned in it: nothing of it is known, and all of what follows is.
TEST(Silence, WhatWasTurnedInAHoleThatIsTooLongIsNotMadeUp) {
  Line line("integrated", 30.0);
  for (int n = 0; n < 1200; ++n)
    if (n < 600 || n >= 900) line.come({n}, n * kPeriod_s);
  const Increment& end = line.increments.at(600);
  EXPECT_EQ(end.flags, kGapBefore);
  EXPECT_EQ(end.covered_s[0], 0.0);
  EXPECT_NEAR(line.increments.at(601).delta_theta_rad[0], 0.3 * kDegree, 1e-9);
  EXPECT_EQ(line.counts().saturated, 0U);
}

// An adapter hands on in portions of 62 bytes what its line brought meanwhile.
TEST(Silence, WhatWasHeldUpAndComesInSmallPortionsIsNoHole) {
  for (const double held_s : {0.3, 0.38, 0.9})
    for (const int portion : {2, 3, 4, 5, 8}) {
      SCOPED_TRACE(std::to_string(held_s) + ", " + std::to_string(portion) + " at once");
      Line line("rate", 0.5);
      for (int n = 0; n < 600; ++n) line.come({n}, n * kPeriod_s);
      const int held = static_cast<int>(std::lround(held_s / kPeriod_s));
      for (int n = 600; n < 600 + held; n += portion) {
        std::vector<int> numbers;
        for (int k = n; k < std::min(n + portion, 600 + held); ++k) numbers.push_back(k);
        line.come(numbers, (600 + held) * kPeriod_s - 5e-3 + 1e-3 * (n - 600) / portion);
      }
      for (int n = 600 + held; n < 1200; ++n) line.come({n}, n * kPeriod_s + 0.05);
      EXPECT_EQ(line.counts().gaps, 0U);
      EXPECT_EQ(line.counts().missing, 0U);
    }
}

TEST(Silence, WhatWasHeldUpAndComesAtOnceIsNoHole) {
  for (const std::string& output :
       {std::string("integrated"), std::string("incremental"), std::string("rate")})
    for (const int portions : {1, 3}) {
      SCOPED_TRACE(output + ' ' + std::to_string(portions));
      Line line(output, 0.5);
      for (int n = 0; n < 600; ++n) line.come({n}, n * kPeriod_s);
      for (int p = 0; p < portions; ++p) {
        std::vector<int> numbers;
        for (int n = 600 + 300 * p / portions; n < 600 + 300 * (p + 1) / portions; ++n) numbers.push_back(n);
        line.come(numbers, 899 * kPeriod_s + 1e-4 * p);
      }
      for (int n = 900; n < 1200; ++n) line.come({n}, n * kPeriod_s);
      EXPECT_EQ(line.counts().gaps, 0U);
      double dt_s = 0.0, angle = 0.0;
      for (const Increment& one : line.increments) {
        dt_s += one.dt_s;
        angle += one.delta_theta_rad[0];
      }
      EXPECT_NEAR(dt_s, 12.0, 0.02);
      EXPECT_NEAR(angle / kDegree, 6.0, 0.02);
    }
}

}  // namespace
}  // namespace ifog
