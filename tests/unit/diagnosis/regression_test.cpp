// SPDX-License-Identifier: Apache-2.0
// The room `regression`: regressors and least squares, against closed forms and normal equations.
#include <gtest/gtest.h>

#include <cmath>

#include "filters/diagnosis/regression/design.h"
#include "filters/diagnosis/regression/uncertainty.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"

namespace ifog {
namespace {

TEST(Design, HasTheMeasurementTheConstantsAndTheEffects) {
  BlockData data = white_with_temperature(100, 2);
  data.grid.records = {{0, 40}, {40, 100}};
  const std::vector<Candidate> effects = {candidate_of(Form::kLinear), candidate_of(Form::kQuadratic)};
  const Columns columns = design(data, effects);
  ASSERT_EQ(columns.cols(), 5);
  EXPECT_EQ(columns.col(0), data.grid.error);
  EXPECT_EQ(columns.col(1).sum(), 40.0);
  EXPECT_EQ(columns.col(2).sum(), 60.0);
  EXPECT_EQ(columns(39, 1), 1.0);
  EXPECT_EQ(columns(40, 2), 1.0);
  const double above = data.channels[0].values[70] - 25.0;
  EXPECT_NEAR(columns(70, 3), above, 1e-12);
  EXPECT_NEAR(columns(70, 4), above * above, 1e-12);
  EXPECT_EQ(column_of(data.grid, effects, 1), 4);
}

// Two turns of two folds over eight blocks: pieces of two blocks, in turn.
TEST(Design, FoldsTakeTurns) {
  const BlockGrid grid = grid_of({8, 4});
  EXPECT_EQ(folds_of(grid, 2, 2), (std::vector<int>{0, 0, 1, 1, 0, 0, 1, 1, 0, 1, 0, 1}));
}

// Without walk and flicker generalised least squares is ordinary: coefficient and variance of a straight line
// through white noise by the textbook's sums.
TEST(Design, SolvesAStraightLine) {
  const BlockData data = white_with_temperature(500, 3);
  Eigen::MatrixXd covariance;
  const Columns columns = design(data, {candidate_of(Form::kLinear)});
  const Eigen::VectorXd c = solve(data.grid, {}, columns, &covariance);
  const Eigen::VectorXd x = columns.col(2).array() - columns.col(2).mean();
  const Eigen::VectorXd y = columns.col(0).array() - columns.col(0).mean();
  const double slope = x.dot(y) / x.squaredNorm();
  EXPECT_NEAR(c[1], slope, 1e-12);
  EXPECT_NEAR(covariance(1, 1), (y - slope * x).squaredNorm() / 498.0 / x.squaredNorm(), 1e-12);
}

TEST(Candidates, OfTimeAreTheirClosedForms) {
  BlockData data;
  data.grid = grid_of({50, 30});
  Candidate candidate;
  candidate.form = Form::kRateRamp;
  EXPECT_EQ(regressors(data, candidate)(49, 0), 49.0);
  EXPECT_EQ(regressors(data, candidate)(50, 0), 0.0);  // a record starts anew
  candidate.form = Form::kWarmUp;
  candidate.time_constant_s = 7.0;
  EXPECT_NEAR(regressors(data, candidate)(14, 0), std::exp(-2.0), 1e-12);
  EXPECT_EQ(regressors(data, step_at(19.5)).col(0).sum(), 30.0);  // of the first record only
  candidate = {};
  candidate.form = Form::kLine;
  candidate.record = 1;
  candidate.frequency_hz = 0.1;
  const Columns line = regressors(data, candidate);
  ASSERT_EQ(line.cols(), 2);
  EXPECT_EQ(line.topRows(50).norm(), 0.0);
  const double kept = std::sin(0.1 * M_PI) / (0.1 * M_PI);  // of a line averaged over a block of a second
  EXPECT_NEAR(line(53, 0), kept * std::cos(2.0 * M_PI * 0.3), 1e-12);
  EXPECT_NEAR(line(53, 1), kept * std::sin(2.0 * M_PI * 0.3), 1e-12);
}

TEST(Candidates, AChannelThatStandsStillIsTriedLinearlyOnly) {
  BlockData data = white_with_temperature(600, 4);
  const auto of_channel = [&] {
    std::vector<Candidate> found = library(data);
    std::erase_if(found, [](const Candidate& each) { return each.channel == Candidate::kNone; });
    return found;
  };
  EXPECT_GT(of_channel().size(), 10U);
  data.channels[0].still = true;
  ASSERT_EQ(of_channel().size(), 1U);
  EXPECT_EQ(of_channel()[0].form, Form::kLinear);
  data.channels[0].varies = false;
  EXPECT_TRUE(of_channel().empty());
}

TEST(Candidates, NoTimeConstantIsLongerThanTheRecordCanShow) {
  const BlockGrid grid = grid_of({900, 300});
  for (const Form form : {Form::kRate, Form::kSecondRate, Form::kLagged}) {
    const std::vector<double> times = time_constants(grid, form);
    ASSERT_FALSE(times.empty());
    EXPECT_LE(times.back(), 300.3);
  }
  EXPECT_LE(time_constants(grid, Form::kSecondRate).back(), 90.1);
  // What warms up has a mass: however short the blocks are.
  EXPECT_GE(time_constants(grid, Form::kWarmUp).front(), 10.0);
}

// The derivative by the logarithm of a lag, against the exponential answer to a step of the channel:
// d/d ln tau of 1 - exp(-t/tau) is -(t/tau) exp(-t/tau).
TEST(Uncertainty, SearchedColumnsAreDerivatives) {
  BlockData data = white_with_temperature(400, 5);
  std::vector<double> step(400, 25.0);
  for (std::size_t i = 10; i < 400; ++i) step[i] = 26.0;
  data.channels = {channel_of("temperature_degC", step)};
  Eigen::VectorXd coefficients(2);
  coefficients << 0.0, 2.0;
  const Columns columns = searched_columns(data, {candidate_of(Form::kLagged, 40.0)}, coefficients, 1);
  ASSERT_EQ(columns.cols(), 1);
  for (const Eigen::Index at : {30, 60, 120}) {
    const double t = static_cast<double>(at - 9) / 40.0;
    EXPECT_NEAR(columns(at, 0), -2.0 * t * std::exp(-t), 0.03);
  }
}

}  // namespace
}  // namespace ifog
