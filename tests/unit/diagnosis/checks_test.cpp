// SPDX-License-Identifier: Apache-2.0
// The room `checks`: what an effect has to prove beyond its likelihood.
#include <gtest/gtest.h>

#include <cmath>

#include "filters/diagnosis/checks/cross_validation.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"

namespace ifog {
namespace {

void add(BlockData& data, const Candidate& effect, double coefficient) {
  data.grid.error += coefficient * regressors(data, effect).col(0);
}

Claimed claimed(const std::vector<Candidate>& model, const NoiseFit& noise) { return {model, noise}; }

// In white noise: least squares on the rows of the other folds, the mean of all rows taken out first.
TEST(CrossValidation, LeavesEachFoldOutOfTheFit) {
  BlockData data = white_with_temperature(800, 1);
  add(data, candidate_of(Form::kLinear), 0.4);
  const Columns columns = design(data, {candidate_of(Form::kLinear)});
  const std::vector<Eigen::VectorXd> found = coefficients_without_each_fold(data.grid, {}, columns);
  const std::vector<int> fold = folds_of(data.grid, 4);
  ASSERT_EQ(found.size(), 4U);
  for (int f = 0; f < 4; ++f) {
    double xy = 0.0;
    double xx = 0.0;
    for (Eigen::Index i = 0; i < columns.rows(); ++i) {
      if (fold[static_cast<std::size_t>(i)] == f) continue;
      const double x = columns(i, 2) - columns.col(2).mean();
      xy += x * (columns(i, 0) - columns.col(0).mean());
      xx += x * x;
    }
    EXPECT_NEAR(found[static_cast<std::size_t>(f)][0], xy / xx, 1e-10);
  }
}

// A step inside the held-out fold is nothing the others could know.
TEST(CrossValidation, WhatOneFoldAloneSawHasNoCoefficientWithoutIt) {
  BlockData data = white_with_temperature(800, 2);
  Columns columns(800, 3);
  columns << data.grid.error, Eigen::VectorXd::Ones(800), Eigen::VectorXd::Zero(800);
  columns.col(2).head(10).setConstant(1.0);
  columns.col(2).segment(10, 10).setConstant(-1.0);  // sums to zero, so that the constant takes nothing of it
  const std::vector<Eigen::VectorXd> found = coefficients_without_each_fold(data.grid, {}, columns);
  EXPECT_EQ(found[0][0], 0.0);
  EXPECT_NE(found[1][0], 0.0);
}

// An error that is the effect and nothing else: nothing is left, between the middles of the first and last
// block.
TEST(CrossValidation, SubtractsAnEffectFromTheSamples) {
  BlockData data = white_with_temperature(500, 3);
  data.grid.error.setZero();
  add(data, candidate_of(Form::kLinear), 2.0);
  std::vector<EvenError> errors(1);
  errors[0].rest.own().assign(data.grid.error.begin(), data.grid.error.end());
  errors[0].rest_held_out = errors[0].rest;
  Eigen::VectorXd coefficients(2);
  coefficients << 0.0, 2.0;
  subtract_effects(data, {candidate_of(Form::kLinear)}, {}, coefficients, errors);
  EXPECT_LT(variance_of(errors[0].after), 1e-20);
  EXPECT_LT(variance_of(errors[0].held_out), 1e-20);  // but for the mean
}

// A swing of ten blocks a period, of which samples are told by block means: what beats with the blocks would
// be taken for a line (0.036 of the swing with straight lines between the means).
TEST(CrossValidation, LeavesNothingOfASwingThatBeatsWithTheBlocks) {
  constexpr std::size_t kBlocks = 400, kSamplesOfBlock = 10;
  BlockData data = white_with_temperature(kBlocks, 3);
  data.grid.sample_s = data.grid.block_s / kSamplesOfBlock;
  data.grid.fine_s = data.grid.sample_s;
  data.grid.fine = kSamplesOfBlock;
  std::vector<double> swing;
  for (std::size_t i = 0; i < kBlocks * kSamplesOfBlock; ++i)
    swing.push_back(std::sin(2.0 * M_PI * static_cast<double>(i) / (10.0 * kSamplesOfBlock)));
  data.channels = {channel_of("accel_x_mps2", swing)};
  std::vector<EvenError> errors(1);
  errors[0].rest.own().assign(swing.begin(), swing.end());
  errors[0].rest_held_out = errors[0].rest;
  Eigen::VectorXd coefficients(2);
  coefficients << 0.0, 1.0;
  subtract_effects(data, {candidate_of(Form::kLinear)}, {}, coefficients, errors);
  const std::span<const double> left = errors[0].after.values();
  double square = 0.0;
  const std::size_t edge = 3 * kSamplesOfBlock;
  for (std::size_t i = edge; i + edge < left.size(); ++i) square += left[i] * left[i];
  EXPECT_LT(std::sqrt(square / static_cast<double>(left.size() - 2 * edge)), 0.004);
}

TEST(Proof, AnEffectThatIsThereIsPredictedAndChanceMostlyIsNot) {
  const std::vector<Candidate> model = {candidate_of(Form::kLinear)};
  int of_chance = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    BlockData data = white_with_temperature(1000, seed);
    const NoiseFit noise{{}, 0.0, 1.0};
    of_chance += predicts_held_out(data, claimed(model, noise)) ? 1 : 0;
    add(data, candidate_of(Form::kLinear), 0.05);  // ten standard deviations
    EXPECT_TRUE(predicts_held_out(data, claimed(model, noise))) << seed;
  }
  // The gain is positive for chance when its z^2 is above about 1 in every direction of the folds: a third.
  EXPECT_LT(of_chance, 32);
}

TEST(Proof, AStepStaysAndAKnockOrASlopeDoesNot) {
  const std::vector<Candidate> model = {step_at(499.5)};
  const NoiseFit noise{{}, 0.0, 1.0};
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const BlockData quiet = white_with_temperature(1000, seed);
    BlockData step = quiet;
    step.grid.error.tail(500).array() += 5.0;
    EXPECT_TRUE(step_persists(step, claimed(model, noise))) << seed;
    BlockData slope = quiet;
    for (Eigen::Index i = 0; i < 1000; ++i)
      slope.grid.error[i] += 5.0 * std::clamp((static_cast<double>(i) - 450.0) / 100.0, 0.0, 1.0);
    EXPECT_FALSE(step_persists(slope, claimed(model, noise))) << seed;
    BlockData knock = quiet;
    knock.grid.error.segment(500, 3).array() += 200.0;
    EXPECT_FALSE(step_persists(knock, claimed(model, noise))) << seed;
  }
}

// It ends soon, and the mean of all that follows is a part of it, which the fit of one step takes for its
// size.
TEST(Proof, AnExcursionIsNoStep) {
  BlockData data = white_with_temperature(1000, 13);
  for (Eigen::Index i = 500; i < 515; ++i) data.grid.error[i] += 9.0;
  const std::vector<Candidate> model = {step_at(499.5)};
  EXPECT_FALSE(step_persists(data, claimed(model, {{}, 0.0, 1.0})));
  EXPECT_FALSE(step_persists(data, claimed(model, {{0.02, 0.0, 0.0, 0.0}, 0.0, 1.0})));
}

// Two states of a structure, not two jumps of a bias: neither lasts. Two that do not cancel are still there.
TEST(Proof, TwoStepsThatCancelDoNotPersist) {
  for (const double back : {-5.0, 3.0}) {
    BlockData data = white_with_temperature(1000, 12);
    data.grid.error.tail(500).array() += 5.0;
    data.grid.error.tail(485).array() += back;
    const NoiseFit noise{{}, 0.0, 1.0};
    const bool lasting = back > 0.0;
    EXPECT_EQ(step_persists(data, claimed({step_at(514.5), step_at(499.5)}, noise)), lasting);
    EXPECT_EQ(step_persists(data, claimed({step_at(499.5), step_at(514.5)}, noise)), lasting);
  }
}

}  // namespace
}  // namespace ifog
