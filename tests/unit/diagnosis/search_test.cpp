// SPDX-License-Identifier: Apache-2.0
// The room `search`: scores, refinement, the choice of effects and what is dropped again.
#include <gtest/gtest.h>

#include <cmath>

#include "filters/diagnosis/channels/reconstruct.h"
#include "filters/diagnosis/search/search.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"

namespace ifog {
namespace {

constexpr std::size_t kBlocks = 1500;

BlockData with_supply(std::uint64_t seed) {
  BlockData data = white_with_temperature(kBlocks, seed);
  std::vector<double> supply(kBlocks);
  for (std::size_t i = 0; i < kBlocks; ++i)
    supply[i] = 12.0 + std::sin(2.0 * M_PI * static_cast<double>(i) / 90.0);
  data.channels.push_back(channel_of("supply_V", supply));
  return data;
}

Candidate of(std::size_t channel, Form form, double time_constant_s = 0.0) {
  Candidate candidate = candidate_of(form, time_constant_s);
  candidate.channel = channel;
  return candidate;
}

void add(BlockData& data, const Candidate& effect, double coefficient) {
  data.grid.error += coefficient * regressors(data, effect).col(0);
}

// A form that no column is made of is refused; one was once written past its matrix.
TEST(Candidates, WhatHasNoColumnIsRefused) {
  const BlockData data = with_supply(1);
  for (const Form form : {Form::kRebuiltRamp, Form::kOutliers, Form::kGaussMarkov}) {
    Candidate none = candidate_of(form, 1.0);
    none.channel = Candidate::kNone;
    EXPECT_THROW(regressors(data, none), std::logic_error);
  }
  Candidate line = candidate_of(Form::kLine, 0.0);
  line.channel = Candidate::kNone;
  line.frequency_hz = 0.1;
  EXPECT_EQ(regressors(data, line).cols(), 2);
}

TEST(Search, TakesTheEffectThatIsThereAndNoOther) {
  BlockData data = with_supply(5);
  const auto search = [&] { return search_effects(with_reconstructed_channels(data), {}); };
  EXPECT_TRUE(search().chosen.empty());
  add(data, of(1, Form::kLinear), 0.5);
  const SearchResult found = search();
  ASSERT_EQ(found.chosen.size(), 1U);
  EXPECT_EQ(found.chosen[0].candidate.channel, 1U);
  EXPECT_EQ(found.chosen[0].candidate.form, Form::kLinear);
  const double sigma = std::sqrt(found.covariance(1, 1));
  EXPECT_NEAR(found.coefficients[1], 0.5, 4.0 * sigma);
  EXPECT_NEAR(sigma, 1.0 / std::sqrt(0.5 * kBlocks), 0.1 * sigma);  // a sine of amplitude 1 in unit noise
  EXPECT_LT(found.chosen[0].p_value, 1e-6);
}

// It jumps at once and comes back within a minute: a step gains more than the supply does, and does not last.
TEST(Search, AKnockThatDoesNotLastHidesNoEffect) {
  BlockData data = with_supply(8);
  add(data, of(1, Form::kLinear), 4.0);
  for (Eigen::Index i = 900; i < data.grid.error.size(); ++i)
    data.grid.error[i] += 30.0 * std::exp(-static_cast<double>(i - 900) / 25.0);
  const SearchResult found = search_effects(with_reconstructed_channels(data), {});
  ASSERT_EQ(found.chosen.size(), 1U);
  EXPECT_EQ(found.chosen[0].candidate.channel, 1U);
  EXPECT_EQ(found.chosen[0].candidate.form, Form::kLinear);
  EXPECT_NEAR(found.coefficients[1], 4.0, 4.0 * std::sqrt(found.covariance(1, 1)));
}

}  // namespace
}  // namespace ifog
