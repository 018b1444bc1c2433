// SPDX-License-Identifier: Apache-2.0
// One impossible number must stay without consequence, and be counted.
#include "filters/chain/plausibility.h"
#include "filters/chain/incrementer.h"
#include "filters/chain/signal_chain.h"
#include "tests/unit/chain/one_axis.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr double kMillisecond_s = 1e-3;
constexpr double kFullScale = 8.55;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

SensorFacts facts(SensorKind kind, double full_scale_radps) {
  SensorFacts out;
  out.kind = kind;
  out.sequence_modulus = 128;
  out.nominal_rate_hz = 1.0 / kMillisecond_s;
  out.full_scale_radps.fill(full_scale_radps);
  out.frame_channels = out.channels = 1;
  return out;
}

// Feeds values that the device calls good, and keeps what a navigator would: the angle and the time it
// covers.
class Feed {
 public:
  explicit Feed(const SensorFacts& of) : incrementer_(of) {}
  const Increment& next(double value, double channel = 25.0) {
    Reading reading;
    reading.sequence = n_++ % 128;
    reading.has_sequence = true;
    reading.valid_axes = 1;
    reading.value[0] = value;
    reading.fresh_channels = 1;
    reading.channel[0] = channel;
    EXPECT_TRUE(incrementer_.next(reading, increment_));
    angle += increment_.delta_theta_rad[0];
    covered += increment_.covered_s[0];
    return increment_;
  }
  void lose(std::uint32_t samples) { n_ += samples; }
  [[nodiscard]] const IncrementerCounts& counts() const { return incrementer_.counts(); }
  double angle = 0.0, covered = 0.0;

 private:
  Incrementer incrementer_;
  Increment increment_;
  std::uint32_t n_ = 0;
};

TEST(Plausibility, ARateThatCannotBeIsInvalidUncoveredAndCounted) {
  for (const double full_scale : {kFullScale, 0.0}) {
    for (const double huge : {1e30, -1e30, 1e200, 2e4, kInfinity, -kInfinity, kNaN}) {
      Feed feed(facts(SensorKind::rate, full_scale));
      feed.next(1.0);
      const Increment& increment = feed.next(huge);
      EXPECT_EQ(increment.valid_axes, 0U) << huge;
      EXPECT_NE(increment.flags & kInvalid, 0U) << huge;
      EXPECT_EQ(increment.covered_s[0], 0.0);
      EXPECT_TRUE(std::isnan(increment.rate_radps[0])) << huge;
      feed.next(1.0);
      EXPECT_EQ(feed.angle, 2e-3) << huge;
      EXPECT_EQ(feed.covered, 2e-3) << huge;
      EXPECT_EQ(feed.counts().invalid, 1U) << huge;
      EXPECT_EQ(feed.counts().saturated + feed.counts().implausible, 1U) << huge;
    }
  }
}

TEST(Plausibility, AtFullScaleTheSensorIsSaturatedAndJustBelowItMeasures) {
  Feed feed(facts(SensorKind::rate, kFullScale));
  EXPECT_EQ(feed.next(std::nextafter(kFullScale, 0.0)).flags, 0U);
  EXPECT_EQ(feed.next(-kFullScale).flags, static_cast<std::uint32_t>(kInvalid | kAtFullScale));
  EXPECT_EQ(feed.counts().saturated, 1U);
  EXPECT_EQ(feed.counts().implausible, 0U);
}

TEST(Plausibility, ADeltaAngleIsJudgedByItsRate) {
  Feed feed(facts(SensorKind::delta_angle, kFullScale));
  EXPECT_EQ(feed.next(8.5e-3).flags, 0U);
  EXPECT_EQ(feed.next(8.6e-3).flags, static_cast<std::uint32_t>(kInvalid | kAtFullScale));
  EXPECT_EQ(feed.angle, 8.5e-3);
}

TEST(Plausibility, OneBadAngleCostsNothingAndANewOriginIsNoRotation) {
  SensorFacts of = facts(SensorKind::angle, kFullScale);
  of.angle_wrap_rad = 2.0 * std::numbers::pi;
  for (const double bad : {1e30, -1e200, 2.0, kInfinity}) {
    Feed feed(of);
    for (int n = 0; n < 10; ++n) feed.next(1e-3 * n);
    EXPECT_EQ(feed.next(bad).covered_s[0], 0.0) << bad;
    for (int n = 11; n < 20; ++n) feed.next(1e-3 * n);
    EXPECT_NEAR(feed.angle, 19e-3, 1e-15) << bad;
    EXPECT_NEAR(feed.covered, 19e-3, 1e-15) << bad;
    EXPECT_EQ(feed.counts().invalid, 1U) << bad;
  }
  Feed feed(of);
  for (int n = 0; n < 10; ++n) feed.next(1e-3 * n);
  for (int n = 0; n < 1000; ++n) feed.next(2.0 + 1e-3 * n);  // set to another origin, and turning on
  EXPECT_NEAR(feed.angle, 9e-3 + 999e-3, 1e-12);
  EXPECT_NEAR(feed.covered, feed.angle, 1e-12);  // at 1 rad/s
  EXPECT_EQ(feed.counts().invalid, 1U);
}

// A device that turns at 2300 °/s for longer than half a turn, unheard or invalid; and one that rests.
TEST(Plausibility, OverAGapInWhichItMayHaveGoneRoundNoTurnIsMadeUp) {
  SensorFacts of = facts(SensorKind::angle, 0.0);
  of.angle_wrap_rad = 2.0 * std::numbers::pi;
  for (const double rate_radps : {40.0, -40.0, 0.0})
    for (const int gap : {20, 60})  // samples of a millisecond
      for (const bool invalid : {false, true}) {
        SCOPED_TRACE(testing::Message() << rate_radps << " rad/s, " << gap << ", invalid " << invalid);
        Feed feed(of);
        int n = 0;
        const auto next = [&] { return std::remainder(1e-3 * rate_radps * n++, of.angle_wrap_rad); };
        while (n <= 100) feed.next(next());
        const double before = feed.angle, gap_s = 1e-3 * gap;
        for (int i = 1; invalid && i < gap; ++i) feed.next(kNaN);
        if (!invalid) feed.lose(static_cast<std::uint32_t>(gap - 1));
        n += gap - 1;
        const bool known = gap_s < (rate_radps == 0.0 ? 2.0 : 0.03);
        EXPECT_NEAR(feed.next(next()).covered_s[0], known ? gap_s : 0.0, 1e-12);
        EXPECT_NEAR(feed.angle - before, known ? rate_radps * gap_s : 0.0, 1e-9);
        EXPECT_NEAR(feed.next(next()).delta_theta_rad[0], 1e-3 * rate_radps, 1e-9);
      }
}

TEST(Plausibility, TheUsersLimitsHold) {
  SensorFacts of = facts(SensorKind::rate, 0.0);
  of.rate = {-1.0, 2.0, 0.5};
  Feed feed(of);
  for (const auto& [rate, good] : {std::pair{0.0, true},
                                   {0.5, true},
                                   {1.1, false},
                                   {0.6, true},
                                   {-1.1, false},
                                   {2.1, false},
                                   {1.5, false},
                                   {1.6, true},
                                   {2.0, true}})
    EXPECT_EQ(feed.next(rate).valid_axes, good ? 1U : 0U) << rate;
  EXPECT_EQ(feed.counts().implausible, 4U);
}

TEST(Plausibility, AChannelKeepsItsLastValueAndGrowsOld) {
  SensorFacts of = facts(SensorKind::rate, 0.0);
  of.channel[0] = {-40.0, 85.0, 5.0};
  Feed feed(of);
  feed.next(0.0, 25.0);
  double age_s = 0.0;
  for (const double bad : {1e200, kInfinity, -41.0, 86.0, 40.0}) {
    const Increment& increment = feed.next(0.0, bad);
    EXPECT_EQ(increment.channel[0], 25.0) << bad;
    EXPECT_NEAR(increment.channel_age_s[0], age_s += kMillisecond_s, 1e-8) << bad;
  }
  EXPECT_EQ(feed.counts().channel_implausible, 5U);
  EXPECT_EQ(feed.next(0.0, 41.0).channel[0], 41.0);  // two that agree: it did go up
}

ChainSettings chain_settings(std::shared_ptr<const Model> model = nullptr) {
  ChainSettings out;
  out.facts = facts(SensorKind::rate, 0.0);
  out.axes = {""};
  out.channels = {"temperature_degC"};
  out.channel_max_age_s = {10.0};
  out.model = std::move(model);
  return out;
}

TEST(Plausibility, NoiseIsLearnedInSpiteOfHugeValues) {
  ChainSettings settings = chain_settings();
  settings.start_up_s = 0.5;
  SignalChain chain(std::make_unique<ChainParts>(settings));
  Feed feed(settings.facts);
  ChainOutput out;
  for (int n = 0; n < 10000; ++n)
    chain.process(feed.next(n % 5 == 3 ? 1e200 : 1e-3 * std::sin(1.7 * n * n)), out);
  EXPECT_TRUE(chain.parts().noise_known());
  EXPECT_LT(std::abs(out.angle_rad[0]), 1e-3);
  EXPECT_TRUE(std::isfinite(out.estimate.denoised_radps[0]));
}

TEST(Plausibility, ACorrectionThatIsNoRateIsRefused) {
  ChainSettings settings =
      chain_settings(linear_in("temperature_degC", 25.0, {"coefficient", 1e-6, 0.0, "rad/s/degC"}));
  settings.filter.process_noise = 1e-10;
  settings.filter.measurement_noise = 1e-8;
  SignalChain chain(std::make_unique<ChainParts>(settings));
  Feed feed(settings.facts);
  ChainOutput out;
  chain.process(feed.next(0.5, 26.0), out);
  EXPECT_EQ(out.flags & kNotCompensated, 0U);
  EXPECT_NEAR(out.compensated_radps[0], 0.5 - 1e-6, 1e-15);
  EXPECT_NEAR(out.angle_rad[0], (0.5 - 1e-6) * kMillisecond_s, 1e-15);
  chain.process(feed.next(0.5, 1e19), out);  // a channel that nobody limits
  EXPECT_NE(out.flags & kNotCompensated, 0U);
  EXPECT_EQ(out.compensated_radps[0], 0.5);
  EXPECT_NEAR(out.angle_rad[0], (1.0 - 1e-6) * kMillisecond_s, 1e-15);
}

}  // namespace
}  // namespace ifog
