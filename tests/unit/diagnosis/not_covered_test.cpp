// SPDX-License-Identifier: Apache-2.0
// What no form describes must not pass for what one does: a loop in the temperature, a coefficient that is
// another one in every part of the record.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "filters/diagnosis/residual/hysteresis.h"

namespace ifog {
namespace {

constexpr std::size_t kBlocks = 3000;

BlockData quiet(std::uint64_t seed, double noise_from_half = 1.0) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  BlockData data;
  BlockGrid& grid = data.grid;
  grid.block_s = grid.fine_s = grid.sample_s = 1.0;
  grid.records = {{0, kBlocks}};
  grid.valid.assign(kBlocks, 1);
  grid.error.resize(static_cast<Eigen::Index>(kBlocks));
  FineChannel channel;
  channel.name = "temperature_degC";
  double walk = 0.0;
  for (std::size_t i = 0; i < kBlocks; ++i) {
    const double t = static_cast<double>(i);
    grid.time_s.push_back(t);
    walk += 0.01 * normal(random);
    grid.error[static_cast<Eigen::Index>(i)] =
        (i < kBlocks / 2 ? 1.0 : noise_from_half) * normal(random) + walk;
    channel.values.push_back(25.0 + 10.0 * std::sin(2.0 * M_PI * t / 1100.0) +
                             4.0 * std::sin(2.0 * M_PI * t / 310.0));
  }
  const auto [low, high] = std::minmax_element(channel.values.begin(), channel.values.end());
  channel.low = *low;
  channel.high = *high;
  channel.varies = channel.smooth = true;
  data.channels = {channel};
  return data;
}

void add(BlockData& data, const Eigen::VectorXd& effect) { data.grid.error += effect; }

Eigen::VectorXd temperature(const BlockData& data) {
  const std::vector<double>& values = data.channels[0].values;
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())).array() -
         25.0;
}

Candidate linear() {
  Candidate candidate;
  candidate.form = Form::kLinear;
  candidate.channel = 0;
  return candidate;
}

std::optional<Hysteresis> found_in(const BlockData& data, const std::vector<Candidate>& model) {
  const NoiseFit noise = fit_noise(data.grid, design(data, model));
  return find_hysteresis(data, model, noise, 0.01);
}

TEST(Hysteresis, IsFoundWithItsWidthAndItsSize) {
  BlockData data = quiet(2);
  add(data, 0.5 * temperature(data) + 0.4 * hysteresis_loop(data, 0, 4.2));
  const auto found = found_in(data, {linear()});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->channel, "temperature_degC");
  EXPECT_NEAR(found->half_width, 4.2, 1.5);
  EXPECT_NEAR(found->coefficient * found->half_width, 0.4 * 4.2, 0.3);
}

// A lag is a loop, too, but of a form that is known, and better described by that.
TEST(Hysteresis, IsNeitherChanceNorALag) {
  int of_chance = 0;
  int of_a_lag = 0;
  for (std::uint64_t seed = 10; seed < 25; ++seed) {
    BlockData data = quiet(seed);
    of_chance += found_in(data, {}) ? 1 : 0;
    Candidate lag = linear();
    lag.form = Form::kLagged;
    lag.time_constant_s = 60.0;
    add(data, 0.5 * regressors(data, lag).col(0));
    of_a_lag += found_in(data, {lag}) ? 1 : 0;
  }
  EXPECT_EQ(of_chance, 0);
  EXPECT_EQ(of_a_lag, 0);
}

}  // namespace
}  // namespace ifog
