// SPDX-License-Identifier: Apache-2.0
// One effect that stands for two: heat through layers, and a direction that a product imitates.
#include <gtest/gtest.h>

#include <cmath>

#include "filters/diagnosis/search/refine.h"
#include "filters/diagnosis/search/unfold.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"

namespace ifog {
namespace {

constexpr std::size_t kBlocks = 3000;

// Of a temperature that has settled, by the exact step of a first-order lag.
void heat_through(BlockData& data, double time_constant_s, double coefficient) {
  const std::vector<double>& x = data.channels[0].values;
  const double share = -std::expm1(-1.0 / time_constant_s);
  double inside = x.front();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double step = share * (x[i] - inside);
    inside += step;
    data.grid.error[static_cast<Eigen::Index>(i)] += coefficient * step;
  }
}

FittedModel fitted(const BlockData& data, std::vector<Candidate> effects) {
  NoiseFit noise = fit_noise(data.grid, design(data, effects));
  for (std::size_t i = 0; i < effects.size(); ++i)
    if (effects[i].searched()) refine(data, noise.shape, effects, i);
  noise = fit_noise(data.grid, design(data, effects), noise.shape);
  return {std::move(effects), std::move(noise)};
}

Candidate of(Form form, std::size_t channel, double time_constant_s = 0.0) {
  Candidate candidate = candidate_of(form, time_constant_s);
  candidate.channel = channel;
  return candidate;
}

TEST(Unfold, HeatThatComesThroughTwoLayersHasTwoTimeConstants) {
  BlockData data = white_with_temperature(kBlocks, 1);
  heat_through(data, 15.0, 60.0);
  heat_through(data, 200.0, 150.0);
  FittedModel model = fitted(data, {of(Form::kRate, 0, 60.0)});
  try_second_layers(data, 0, model);
  ASSERT_EQ(model.effects.size(), 2U);
  const auto [quick, slow] = std::minmax(model.effects[0].time_constant_s, model.effects[1].time_constant_s);
  EXPECT_NEAR(std::log(quick / 15.0), 0.0, 0.25);
  EXPECT_NEAR(std::log(slow / 200.0), 0.0, 0.25);
}

TEST(Unfold, HeatThatComesThroughOneLayerHasOne) {
  for (std::uint64_t seed = 10; seed < 20; ++seed) {
    BlockData data = white_with_temperature(kBlocks, seed);
    heat_through(data, 60.0, 200.0);
    FittedModel model = fitted(data, {of(Form::kRate, 0, 60.0)});
    try_second_layers(data, 0, model);
    EXPECT_EQ(model.effects.size(), 1U) << seed;
  }
}

// Both stay far from zero, where a product is nearly a sum.
BlockData far_from_zero(const std::string& one, const std::string& other, std::uint64_t seed) {
  BlockData data = white_with_temperature(kBlocks, seed);
  std::vector<double> a(kBlocks), b(kBlocks);
  for (std::size_t i = 0; i < kBlocks; ++i) {
    a[i] = 15.0 + 4.0 * std::sin(2.0 * M_PI * static_cast<double>(i) / 330.0);
    b[i] = 23.0 + 5.0 * std::sin(2.0 * M_PI * static_cast<double>(i) / 210.0);
  }
  data.channels.push_back(channel_of(one, a));
  data.channels.push_back(channel_of(other, b));
  return data;
}

Candidate product(const BlockData& data) {
  for (const Candidate& each : products_of(data, 1))
    if (each.with_channel == 2) return each;
  return {};
}

TEST(Unfold, AFieldAcrossTwoAxesIsADirectionAndNoProduct) {
  BlockData data = far_from_zero("magnetic_x_uT", "magnetic_y_uT", 2);
  data.grid.error += 0.1 * regressors(data, of(Form::kLinear, 1)).col(0);
  data.grid.error += 0.1 * regressors(data, of(Form::kLinear, 2)).col(0);
  FittedModel model = fitted(data, {product(data)});
  try_factors_apart(data, 0, model);
  ASSERT_EQ(model.effects.size(), 2U);
  EXPECT_EQ(model.effects[0].form, Form::kLinear);
  EXPECT_EQ(model.effects[1].form, Form::kLinear);
}

TEST(Unfold, AProductStaysOne) {
  for (std::uint64_t seed = 30; seed < 40; ++seed) {
    BlockData data = far_from_zero("supply_V", "pressure_hPa", seed);
    const Candidate both = product(data);
    data.grid.error += 0.02 * regressors(data, both).col(0);
    FittedModel model = fitted(data, {both});
    try_factors_apart(data, 0, model);
    EXPECT_EQ(model.effects.size(), 1U) << seed;
  }
}

}  // namespace
}  // namespace ifog
