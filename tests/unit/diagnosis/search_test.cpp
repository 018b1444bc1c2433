// SPDX-License-Identifier: Apache-2.0
// The room `search`: scores, refinement, the choice of effects and what is dropped again.
#include <gtest/gtest.h>

#include <cmath>

#include "filters/diagnosis/channels/reconstruct.h"
#include "filters/diagnosis/search/acceptance.h"
#include "filters/diagnosis/search/refine.h"
#include "filters/diagnosis/search/scan.h"
#include "filters/diagnosis/search/search.h"
#include "filters/linear/least_squares.h"
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

// From -3 to 3: a transition about 2 with a half width of 1.5 has only begun to level out at 3.
TEST(Search, OfATransitionBothLevelsHaveToBeSeen) {
  BlockData data;
  data.channels.push_back(channel_of("temperature_degC", {-3.0, 0.0, 3.0}));
  data.channels[0].low = -3.0;
  data.channels[0].high = 3.0;
  Candidate transition = of(0, Form::kTransition);
  transition.half_width = 1.5;
  for (const auto& [centre, seen] : {std::pair{0.0, true}, {1.4, true}, {2.0, false}, {-2.0, false}}) {
    transition.centre = centre;
    EXPECT_EQ(levels_seen(data, {of(0, Form::kLinear), transition}), seen) << centre;
  }
}

// One that levels out just within the range may fit a little better still wider, and is none then; of those
// that are one, the likeliest counts.
TEST(Refine, ATransitionStaysOneWhoseLevelsAreSeen) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    BlockData data = white_with_temperature(kBlocks, seed);
    Candidate truth = of(0, Form::kTransition);
    truth.centre = 24.0;
    truth.half_width = 8.5;
    add(data, truth, 1.0);
    std::vector<Candidate> model = {truth};
    const NoiseShape shape = fit_noise(data.grid, design(data, model)).shape;
    refine_shape(data, shape, model, 0);
    EXPECT_TRUE(levels_seen(data, model)) << seed << ": " << model[0].half_width;
    EXPECT_NEAR(model[0].centre, 24.0, 3.0) << seed;
  }
}

// Of a channel that acts at once noise likes a short lag now and then, for a lag is one parameter more: by
// chance it gains the price in less than one sensor of a hundred.
TEST(Refine, WhatActsAtOnceSeldomGetsALag) {
  constexpr std::uint64_t kSensors = 300;
  int lags = 0;
  for (std::uint64_t seed = 1; seed <= kSensors; ++seed) {
    BlockData data = with_supply(seed);
    add(data, of(1, Form::kLinear), 0.5);
    std::vector<Candidate> model = {of(1, Form::kLinear)};
    const NoiseShape white;
    const double at_once = fit_whitened(data.grid, white, design(data, model)).log_likelihood;
    const double price = complexity(of(1, Form::kLagged)) - complexity(model[0]);
    double gain = 0.0;
    for (const double lag : {3.0, 7.0, 18.0}) {
      model[0] = of(1, Form::kLagged, lag);
      refine(data, white, model, 0);
      gain = std::max(gain,
                      2.0 * (fit_whitened(data.grid, white, design(data, model)).log_likelihood - at_once));
    }
    lags += gain > price ? 1 : 0;
  }
  EXPECT_LT(lags, 0.01 * kSensors);
}

Scored best_of(const std::vector<Scored>& scored) {
  return *std::max_element(scored.begin(), scored.end(),
                           [](const Scored& a, const Scored& b) { return a.ratio < b.ratio; });
}

// In white noise a score is n log of the residual before over after, by ordinary least squares.
TEST(Scan, ScoresAreLikelihoodRatios) {
  BlockData data = with_supply(1);
  add(data, of(1, Form::kLinear), 0.5);
  const Scan scan(data, {of(0, Form::kLinear), of(1, Form::kLinear)});
  NoiseFit noise;
  noise.log_likelihood = fit_whitened(data.grid, {}, design(data, {})).log_likelihood;
  const std::vector<Scored> scored = scan.score({}, noise, false);
  for (std::size_t c = 0; c < 2; ++c) {
    Columns with(static_cast<Eigen::Index>(kBlocks), 2);
    with << Eigen::VectorXd::Ones(static_cast<Eigen::Index>(kBlocks)), regressors(data, of(c, Form::kLinear));
    const double before = left_by(with.leftCols(1), data.grid.error).squaredNorm();
    const double after = left_by(with, data.grid.error).squaredNorm();
    EXPECT_NEAR(scored[c].ratio, std::max(0.0, double(kBlocks) * std::log(before / after)), 1e-6);
  }
  EXPECT_EQ(best_of(scored).candidate.channel, 1U);
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

TEST(Refine, FindsTheLag) {
  BlockData data = with_supply(4);
  add(data, of(0, Form::kLagged, 60.0), 1.0);
  std::vector<Candidate> model = {of(0, Form::kLagged, 40.0)};
  refine(data, {}, model, 0);
  EXPECT_NEAR(model[0].time_constant_s, 60.0, 2.0);
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

std::vector<EvenError> errors_of(const BlockData& data) {
  EvenError error;
  error.before.own().assign(data.grid.error.begin(), data.grid.error.end());
  error.rest = error.rest_held_out = error.before;
  return {error};
}

// Coefficients that are not those of the data make the error on held-out blocks larger: nothing holds.
TEST(Acceptance, AnErrorThatGrowsDoesNotHold) {
  const BlockData data = with_supply(7);
  std::vector<EvenError> errors = errors_of(data);
  errors[0].held_out = errors[0].before;
  EXPECT_TRUE(holds(errors, &EvenError::held_out));
  for (std::size_t i = 0; i < kBlocks; ++i) errors[0].held_out.own()[i] += data.channels[1].values[i] - 12.0;
  EXPECT_FALSE(holds(errors, &EvenError::held_out));
}

}  // namespace
}  // namespace ifog
