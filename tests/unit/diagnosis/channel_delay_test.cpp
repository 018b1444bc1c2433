// SPDX-License-Identifier: Apache-2.0
// A channel that was logged late is told by how much, and its effect is found all the same.
#include "filters/diagnosis/checks/channel_delay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <span>

#include "filters/diagnosis/diagnose.h"
#include "filters/diagnosis/record/compensated_error.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"

namespace ifog {
namespace {

constexpr std::size_t kSamples = 7200;  // of a second

// A supply that consumers pull down and let go: level after level, each held for half a minute to two and
// reached within a second or two. The same seed gives the same supply.
class Supply {
 public:
  explicit Supply(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> level(11.6, 12.4), held(30.0, 120.0);
    for (double t = -200.0; t < 8000.0; t += held(random)) steps_.push_back({t, level(random)});
  }
  [[nodiscard]] double at(double t) const {
    double volts = steps_.front().second;
    for (std::size_t i = 1; i < steps_.size(); ++i)
      volts +=
          (steps_[i].second - steps_[i - 1].second) * 0.5 * (1.0 + std::tanh((t - steps_[i].first) / 1.5));
    return volts;
  }

 private:
  std::vector<std::pair<double, double>> steps_;
};

Diagnosis diagnosis_of(std::uint64_t seed, double delay_s, double lag_s = 0.0) {
  std::mt19937_64 random(1000 + seed);
  std::normal_distribution<double> normal;
  const Supply supply(seed);
  std::vector<double> time, rate, volts;
  double lagged = supply.at(0.0);
  for (std::size_t i = 0; i < kSamples; ++i) {
    const auto t = static_cast<double>(i);
    lagged = lag_s > 0.0 ? lagged + (supply.at(t) - lagged) * -std::expm1(-1.0 / lag_s) : supply.at(t);
    time.push_back(t);
    rate.push_back(2e-6 * (lagged - 12.0) + 1e-6 * normal(random));
    volts.push_back(std::round((supply.at(t - delay_s) + 5e-4 * normal(random)) * 1e3) / 1e3);
  }
  Record record;
  record.name = "logged";
  record.time_s = time;
  record.rate_radps = rate;
  record.channels = {{"supply_V", volts}};
  return diagnose({record}, {});
}

TEST(ChannelDelay, ALateChannelIsToldByHowMuch) {
  for (const double delay_s : {4.3, 11.0, 27.5}) {
    const Diagnosis found = diagnosis_of(3, delay_s);
    ASSERT_EQ(found.channel_delays.size(), 1U) << delay_s;
    EXPECT_EQ(found.channel_delays[0].channel, "supply_V");
    EXPECT_NEAR(found.channel_delays[0].delay_s, delay_s,
                std::max(1.0, 4.0 * found.channel_delays[0].std_error_s));
    ASSERT_EQ(found.effects.size(), 1U) << delay_s;
    EXPECT_EQ(found.effects[0].effect.form, "linear");
    const ModelParameter& size = found.effects[0].effect.parameters[0];
    EXPECT_NEAR(size.value, 2e-6, 4.0 * size.std_error) << delay_s;
    EXPECT_TRUE(std::any_of(found.remarks.begin(), found.remarks.end(), [](const std::string& remark) {
      return remark.starts_with("supply_V logged ") && remark.find(" s late (+-") != std::string::npos;
    }));
  }
}

// A supply in time, and one whose effect comes through a capacitor: a lag is no channel logged early or late.
TEST(ChannelDelay, AChannelInTimeHasNone) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    EXPECT_TRUE(diagnosis_of(seed, 0.0).channel_delays.empty()) << seed;
    EXPECT_TRUE(diagnosis_of(seed, 0.0, 20.0).channel_delays.empty()) << seed;
  }
}

// On a table that goes to and fro: a supply that acts by nothing but the scale factor, logged late or early.
struct Turned {
  std::vector<double> time, rate, turn, volts, warmth;

  Turned(std::uint64_t seed, double delay_s) {
    std::mt19937_64 random(2000 + seed);
    std::normal_distribution<double> normal;
    const Supply supply(seed);
    for (std::size_t i = 0; i < kSamples; ++i) {
      const auto t = static_cast<double>(i);
      time.push_back(t);
      turn.push_back(0.03 * std::sin(2.0 * M_PI * t / 170.0));
      rate.push_back(turn.back() * (1.0 + 4e-4 * (supply.at(t) - 11.9)) + 1e-6 * normal(random));
      volts.push_back(std::round((supply.at(t - delay_s) + 5e-4 * normal(random)) * 1e3) / 1e3);
      warmth.push_back(24.0 + 3.0 * std::sin(2.0 * M_PI * t / 1900.0) + 0.01 * normal(random));
    }
  }
  [[nodiscard]] Record record() const {
    Record record;
    record.name = "turned";
    record.time_s = time;
    record.rate_radps = rate;
    record.reference_radps = turn;
    record.channels = {{"supply_V", volts}, {"temperature_degC", warmth}};
    return record;
  }
};

// Of means of 10 s, without the first minute: what was early then was said before.
double rms_of_means(std::span<const double> error) {
  error = error.subspan(60);
  constexpr std::size_t kMean = 10;
  double square = 0.0, n = 0.0;
  for (std::size_t i = 0; i + kMean <= error.size(); i += kMean, n += 1.0) {
    double sum = 0.0;
    for (std::size_t k = 0; k < kMean; ++k) sum += error[i + k];
    square += sum * sum / (kMean * kMean);
  }
  return std::sqrt(square / n);
}

TEST(ChannelDelay, IsFoundThroughAProductWithTheRate) {
  for (const double delay_s : {14.0, -38.0}) {
    const Turned turned(5, delay_s);
    const Diagnosis found = diagnose({turned.record()}, {});
    ASSERT_EQ(found.channel_delays.size(), 1U) << delay_s;
    EXPECT_EQ(found.channel_delays[0].channel, "supply_V");
    EXPECT_NEAR(found.channel_delays[0].delay_s, delay_s,
                std::max(1.0, 4.0 * found.channel_delays[0].std_error_s));
    const auto product = std::find_if(found.effects.begin(), found.effects.end(),
                                      [](const FoundEffect& each) { return each.effect.form == "product"; });
    ASSERT_NE(product, found.effects.end()) << delay_s;
    EXPECT_EQ(found.effects.size(), 2U) << delay_s;  // the scale factor at the supply's zero is the other
    const ModelParameter& size = product->effect.parameters[0];
    EXPECT_NEAR(size.value, 4e-4, 4.0 * size.std_error) << delay_s;
  }
}

TEST(ChannelDelay, AnEarlyChannelIsCorrectedWhenItActs) {
  const Turned first(5, -38.0), next(6, -38.0);
  const Diagnosis found = diagnose({first.record()}, {});
  Model model;
  add_to_model(found, "", model);
  const double white = 1e-6 / std::sqrt(10.0);
  EXPECT_GT(rms_of_means(compensated_error(next.record(), {})), 4.0 * white);
  EXPECT_LT(rms_of_means(compensated_error(next.record(), model)), 1.1 * white);
}

TEST(ChannelDelay, UndoneItIsTheChannelBefore) {
  const BlockGrid grid = grid_of({400, 300});
  std::vector<double> line;
  for (int k = 0; k < 700; ++k) line.push_back(k < 400 ? 0.1 * k : 5.0 - 0.2 * (k - 400));
  FineChannel channel = channel_of("supply_V", line);
  undo_delay(grid, 12.25, channel);
  for (int k = 0; k < 380; ++k)
    EXPECT_NEAR(channel.values[static_cast<std::size_t>(k)], 0.1 * (k + 12.25), 1e-12);
  for (int k = 400; k < 680; ++k)
    EXPECT_NEAR(channel.values[static_cast<std::size_t>(k)], 5.0 - 0.2 * (k - 400 + 12.25), 1e-12);
  EXPECT_EQ(channel.values[399], line[399]);  // held: what came later was never logged
}

}  // namespace
}  // namespace ifog
