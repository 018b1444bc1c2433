// SPDX-License-Identifier: Apache-2.0
// Of a device that sends its running angle: what it turned over a silence belongs to all of the silence, also
// where only the frames that follow tell how long that was.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <tuple>

#include "daemon/sensor/facts.h"
#include "drivers/host/driver_instance.h"
#include "filters/chain/incrementer.h"
#include "tests/unit/drivers/start_time.h"

namespace ifog {
namespace {

constexpr double kOneDegree = std::numbers::pi / 180.0;

// A STIM300 that turns at a steady rate; its frames have a counter of 8 bits and no clock that goes on.
class TurningStim {
 public:
  // wraps: at 8°, as its maker has it, so that over a second and more nobody knows which way round it went.
  TurningStim(double rate_hz, double rate_degps, bool wraps)
      : period_s_(1.0 / rate_hz),
        rate_degps_(rate_degps),
        driver_(make_driver("stim300", {{"output", "integrated_angle"},
                                        {"rate_hz", std::to_string(static_cast<int>(rate_hz))}})),
        facts_(sensor_facts(driver_.description(), 0.0, 0)),
        incrementer_(without_wrap(facts_, wraps)) {}

  // It measures for so long; what it sends comes after `held_s` more, less what came before, as it was sent.
  void measures(double time_s) {
    for (const double end_s = time_s_ + time_s - 0.5 * period_s_; time_s_ < end_s;) {
      step();
      deliver(time_s_);
    }
  }
  void is_lost(double time_s) {
    for (const double end_s = time_s_ + time_s - 0.5 * period_s_; time_s_ < end_s; ++lost_) step();
  }
  // Held up, and then all of it at `speed` times the pace.
  void is_held_up(double time_s, double speed) {
    const double begun_s = time_s_, free_s = begun_s + time_s;
    while (true) {
      step();
      const double comes_s = free_s + (time_s_ - begun_s) / speed;
      if (comes_s <= time_s_) return deliver(time_s_);
      deliver(comes_s);
    }
  }
  // It measures nothing, and is turned on all the same.
  void pauses(double time_s) {
    angle_deg_ += rate_degps_ * time_s;
    time_s_ += time_s;
  }

  double fastest_degps = -1e9, slowest_degps = 1e9;
  double turned_deg = 0.0, passed_s = 0.0, covered_s = 0.0;
  [[nodiscard]] double angle_deg() const { return angle_deg_ - first_deg_; }
  [[nodiscard]] std::uint64_t lost() const { return lost_; }
  [[nodiscard]] std::uint64_t missing() const { return incrementer_.counts().missing; }

 private:
  static const SensorFacts& without_wrap(SensorFacts& facts, bool wraps) {
    if (!wraps) facts.angle_wrap_rad = 0.0;
    return facts;
  }
  void step() {
    time_s_ += period_s_;
    angle_deg_ += rate_degps_ * period_s_;
    ++sequence_;
  }
  void deliver(double arrival_s) {
    Reading reading;
    reading.valid_axes = 1;
    reading.value[0] =
        std::remainder(angle_deg_ * kOneDegree, facts_.angle_wrap_rad > 0.0 ? facts_.angle_wrap_rad : 1e9);
    reading.has_sequence = true;
    reading.sequence = static_cast<std::uint32_t>(sequence_ % facts_.sequence_modulus);
    reading.arrival_ns = kStart_ns + static_cast<std::int64_t>((arrival_s + scatter_(random_)) * 1e9);
    Increment out;
    if (!incrementer_.next(reading, out)) return;
    if (!begun_) first_deg_ = angle_deg_;
    if (begun_) passed_s += out.dt_s;
    begun_ = true;
    turned_deg += out.delta_theta_rad[0] / kOneDegree;
    covered_s += out.covered_s[0];
    if (!std::isfinite(out.rate_radps[0]) || out.covered_s[0] == 0.0) return;
    fastest_degps = std::max(fastest_degps, out.rate_radps[0] / kOneDegree);
    slowest_degps = std::min(slowest_degps, out.rate_radps[0] / kOneDegree);
  }

  double period_s_, rate_degps_;
  DriverInstance driver_;
  SensorFacts facts_;
  Incrementer incrementer_;
  std::mt19937 random_{11};
  std::uniform_real_distribution<double> scatter_{0.0, 2e-4};
  double time_s_ = 0.0, angle_deg_ = 0.0, first_deg_ = 0.0;
  std::uint64_t sequence_ = 0, lost_ = 0;
  bool begun_ = false;
};

using Turning = std::tuple<double, bool>;  // °/s; whether the angle goes round

class OpenTurns : public testing::TestWithParam<Turning> {
 protected:
  // What is in the sum was turned in the time that it says, and no sample turned faster than the gyro.
  static void expect_true(const TurningStim& gyro, double rate_degps) {
    EXPECT_NEAR(gyro.turned_deg, rate_degps * gyro.covered_s, 0.06 * 0.5);
    EXPECT_LT(gyro.fastest_degps, rate_degps + 0.1 * std::abs(rate_degps) + 0.06);
    EXPECT_GT(gyro.slowest_degps, rate_degps - 0.1 * std::abs(rate_degps) - 0.06);
  }
};

TEST_P(OpenTurns, OfALostTimeIsTurnedInAllOfIt) {
  const auto [rate_degps, wraps] = GetParam();
  for (const double lost_s : {3.0, 10.0, 20.0}) {
    SCOPED_TRACE(lost_s);
    TurningStim gyro(500.0, rate_degps, wraps);
    gyro.measures(5.0);
    gyro.is_lost(lost_s);
    gyro.measures(4.0);
    EXPECT_EQ(gyro.missing(), gyro.lost());
    EXPECT_NEAR(gyro.passed_s, 9.0 + lost_s, 0.01);
    expect_true(gyro, rate_degps);
    if (wraps) continue;
    EXPECT_NEAR(gyro.turned_deg, gyro.angle_deg(), 1e-6 * (1.0 + std::abs(gyro.angle_deg())));
  }
}

TEST_P(OpenTurns, OfAHoldUpIsThereWhenItHasDrained) {
  const auto [rate_degps, wraps] = GetParam();
  TurningStim gyro(500.0, rate_degps, wraps);
  gyro.measures(5.0);
  gyro.is_held_up(4.0, 10.0);
  gyro.measures(4.0);
  EXPECT_EQ(gyro.missing(), 0U);
  EXPECT_NEAR(gyro.turned_deg, gyro.angle_deg(), 1e-6 * (1.0 + std::abs(gyro.angle_deg())));
  EXPECT_NEAR(gyro.covered_s, gyro.passed_s, 0.01);
  expect_true(gyro, rate_degps);
}

TEST_P(OpenTurns, OfAPauseIsOwed) {
  const auto [rate_degps, wraps] = GetParam();
  TurningStim gyro(500.0, rate_degps, wraps);
  gyro.measures(5.0);
  gyro.pauses(4.3);
  gyro.measures(4.0);
  EXPECT_EQ(gyro.missing(), 0U);
  const double not_told_deg = wraps ? rate_degps * (4.3 + 0.002) : 0.0;
  EXPECT_NEAR(gyro.turned_deg, gyro.angle_deg() - not_told_deg, 1e-6 * (1.0 + std::abs(gyro.angle_deg())));
  EXPECT_LT(gyro.fastest_degps, rate_degps + 0.1 * std::abs(rate_degps) + 0.06);
  EXPECT_GT(gyro.slowest_degps, rate_degps - 0.1 * std::abs(rate_degps) - 0.06);
}

// Which by chance is eight rounds of the counter long, and is taken for them.
TEST_P(OpenTurns, OfAPauseLikeALossIsNoFasterEither) {
  const auto [rate_degps, wraps] = GetParam();
  TurningStim gyro(500.0, rate_degps, wraps);
  gyro.measures(5.0);
  gyro.pauses(8 * 256 / 500.0);
  gyro.measures(4.0);
  EXPECT_EQ(gyro.missing(), 8U * 256U);
  expect_true(gyro, rate_degps);
}

INSTANTIATE_TEST_SUITE_P(Rates, OpenTurns,
                         testing::Combine(testing::Values(0.0, 0.02, 1.0, -1.0, 20.0), testing::Bool()));

}  // namespace
}  // namespace ifog
