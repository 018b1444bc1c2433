// SPDX-License-Identifier: Apache-2.0
// What a record showed of a law is seldom all of it, and elsewhere the missing term is the error.
#include <gtest/gtest.h>

#include <cmath>

#include "filters/diagnosis/regression/uncertainty.h"
#include "filters/diagnosis/search/complete_laws.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"

namespace ifog {
namespace {

constexpr std::size_t kBlocks = 3000;

// As a search leaves what it found.
SearchResult found_in(const BlockData& data, std::vector<Candidate> model) {
  SearchResult found;
  const Columns columns = design(data, model);
  found.noise = fit_noise(data.grid, columns);
  found.coefficients = solve(data.grid, found.noise.shape, columns, &found.covariance);
  found.fitted_coefficients = found.coefficients;
  for (const Candidate& each : model) found.chosen.push_back({each, 100.0, 1e-9});
  found.fitted = std::move(model);
  return found;
}

double coefficient(const BlockData& data, const SearchResult& found, Form form, double period = 0.0) {
  const JointFit joint = joint_fit(data, found.fitted, found.fitted_coefficients, found.noise);
  for (std::size_t i = 0; i < found.fitted.size(); ++i)
    if (found.fitted[i].form == form && found.fitted[i].period == period)
      return joint.values[column_of(data.grid, found.fitted, i) - 1];
  return 0.0;
}

bool has(const SearchResult& found, Form form, double period = 0.0) {
  return std::any_of(found.fitted.begin(), found.fitted.end(),
                     [&](const Candidate& each) { return each.form == form && each.period == period; });
}

// A table that swings by so much to either side of `middle`, in unit white noise.
BlockData on_an_arc(double middle, double reach, std::uint64_t seed) {
  BlockData data = white_with_temperature(kBlocks, seed);
  std::vector<double> angle(kBlocks);
  for (std::size_t i = 0; i < kBlocks; ++i) {
    const double t = static_cast<double>(i);
    angle[i] =
        middle + reach * (0.6 * std::sin(2.0 * M_PI * t / 210.0) + 0.4 * std::sin(2.0 * M_PI * t / 83.0));
  }
  data.channels[0] = channel_of("table_rad", angle);
  data.channels[0].period = 2.0 * M_PI;
  return data;
}

void once_a_turn(BlockData& data, double size, double phase, double twice) {
  for (std::size_t i = 0; i < data.grid.size(); ++i) {
    const double a = data.channels[0].values[i];
    data.grid.error[static_cast<Eigen::Index>(i)] += size * (std::cos(a + phase) + twice * std::cos(2.0 * a));
  }
}

Candidate swing(Form form, double part_of_turn = 1.0) {
  Candidate candidate = candidate_of(form);
  candidate.period = 2.0 * M_PI * part_of_turn;
  return candidate;
}

// Root mean square error all round the circle, over that of the swing.
double left_round_the_circle(const BlockData& data, const SearchResult& found, double size, double phase,
                             double twice) {
  const JointFit joint = joint_fit(data, found.fitted, found.fitted_coefficients, found.noise);
  double square = 0.0, of_swing = 0.0;
  for (int k = 0; k < 360; ++k) {
    const double a = k * M_PI / 180.0;
    double left = size * (std::cos(a + phase) + twice * std::cos(2.0 * a));
    of_swing += left * left;
    for (std::size_t i = 0; i < found.fitted.size(); ++i) {
      const double c = joint.values[column_of(data.grid, found.fitted, i) - 1];
      const double turns = 2.0 * M_PI / found.fitted[i].period;
      left -= c * (found.fitted[i].form == Form::kCosine ? std::cos(turns * a) : std::sin(turns * a));
    }
    square += left * left;
  }
  return std::sqrt(square / of_swing);
}

TEST(CompleteLaws, ASwingOfWhichTheCosineWasFoundHasASine) {
  double with = 0.0, without = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    BlockData data = on_an_arc(0.4, 0.7, seed);
    once_a_turn(data, 0.5, 0.4, 0.4);
    SearchResult found = found_in(data, {swing(Form::kCosine)});
    const double before = left_round_the_circle(data, found, 0.5, 0.4, 0.4);
    EXPECT_TRUE(complete_laws(data, data, found));
    EXPECT_TRUE(has(found, Form::kSine, 2.0 * M_PI));
    const double after = left_round_the_circle(data, found, 0.5, 0.4, 0.4);
    with += after * after;
    without += before * before;
    ASSERT_EQ(found.chosen.size(), found.fitted.size());
    EXPECT_EQ(found.chosen.back().p_value, 1e-9) << "the law's";
    SearchResult again = found;
    complete_laws(data, data, again);
    EXPECT_EQ(again.fitted.size(), found.fitted.size()) << "there is no more of it";
  }
  EXPECT_LT(with, 0.5 * without);
}

// What turns bends as well: the arc shows too little of it to miss it, and the circle all of it.
TEST(CompleteLaws, AnArcThatToldOnceATurnLeavesTwiceToBeExpected) {
  double with = 0.0, without = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    BlockData data = on_an_arc(0.4, 0.7, seed);
    once_a_turn(data, 2.0, 0.8, 0.5);
    SearchResult found = found_in(data, {swing(Form::kCosine), swing(Form::kSine)});
    const double before = left_round_the_circle(data, found, 2.0, 0.8, 0.5);
    complete_laws(data, data, found);
    const double after = left_round_the_circle(data, found, 2.0, 0.8, 0.5);
    with += after * after;
    without += before * before;
  }
  EXPECT_LT(with, 0.5 * without);
}

// An arc that tells a sine from a straight line no better than this: least squares on all four would make of
// them what it likes.
TEST(CompleteLaws, CoefficientsAreNoLargerThanTheSwing) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    BlockData data = on_an_arc(0.2, 0.5, seed);
    once_a_turn(data, 0.5, 0.2, 0.4);
    SearchResult found = found_in(data, {swing(Form::kCosine)});
    complete_laws(data, data, found);
    EXPECT_LT(left_round_the_circle(data, found, 0.5, 0.2, 0.4), 2.0) << seed;
  }
}

TEST(CompleteLaws, WhatARecordShowsNotToBeThereStaysOut) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    BlockData data = on_an_arc(0.4, 9.0, seed);
    once_a_turn(data, 2.0, 0.4, 0.0);
    SearchResult found = found_in(data, {swing(Form::kCosine), swing(Form::kSine)});
    complete_laws(data, data, found);
    EXPECT_EQ(found.fitted.size(), 2U) << seed;
    EXPECT_NEAR(coefficient(data, found, Form::kCosine, 2.0 * M_PI), 2.0 * std::cos(0.4), 0.15);
  }
}

// 3 (T - 23)^2 between 14 and 36 degrees: about 25 degrees it is a square alone, nearly.
TEST(CompleteLaws, ASquareHasATurningPoint) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    BlockData data = white_with_temperature(kBlocks, seed);
    data.grid.error.array() +=
        0.005 * (regressors(data, candidate_of(Form::kLinear)).col(0).array() + 2.0).square();
    SearchResult found = found_in(data, {candidate_of(Form::kQuadratic)});
    EXPECT_TRUE(complete_laws(data, data, found));
    ASSERT_TRUE(has(found, Form::kLinear));
    EXPECT_NEAR(coefficient(data, found, Form::kLinear), 0.02, 0.012) << seed;
  }
}

TEST(CompleteLaws, ALineHasASquareWhereTheErrorAsksForIt) {
  int squares = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    BlockData data = white_with_temperature(kBlocks, seed);
    data.grid.error += 0.03 * regressors(data, candidate_of(Form::kLinear)).col(0);
    SearchResult found = found_in(data, {candidate_of(Form::kLinear)});
    complete_laws(data, data, found);
    squares += has(found, Form::kQuadratic) ? 1 : 0;
  }
  EXPECT_LE(squares, 4) << "a line is a line";
  BlockData data = white_with_temperature(kBlocks, 1);
  data.grid.error += 0.03 * regressors(data, candidate_of(Form::kLinear)).col(0) +
                     0.0025 * regressors(data, candidate_of(Form::kQuadratic)).col(0);
  SearchResult found = found_in(data, {candidate_of(Form::kLinear)});
  complete_laws(data, data, found);
  EXPECT_TRUE(has(found, Form::kQuadratic));
}

// A heater warms the coil from a temperature that nobody knows.
TEST(CompleteLaws, WhatASwitchLetsThroughActsAboutAPointOfItsOwn) {
  BlockData data = white_with_temperature(kBlocks, 3);
  std::vector<double> on(kBlocks);
  for (std::size_t i = 0; i < kBlocks; ++i) on[i] = i / 170 % 2 == 0 ? 1.0 : 0.0;
  data.channels.push_back(channel_of("heater_on", on));
  data.channels[1].two_valued = true;
  Candidate product = candidate_of(Form::kProduct);
  product.with_channel = 1;
  product.with_form = Form::kLinear;
  data.grid.error += 0.1 * regressors(data, product).col(0);
  SearchResult found = found_in(data, {product});
  complete_laws(data, data, found);
  ASSERT_EQ(found.fitted.size(), 2U);
  EXPECT_EQ(found.fitted[1].form, Form::kLinear);
  EXPECT_EQ(found.fitted[1].channel, 1U);
}

TEST(CompleteLaws, OfARateTableEachDwellCountsAndNothingIsAdded) {
  BlockData data = on_an_arc(0.4, 0.7, 1);
  data.grid.dwells = true;
  once_a_turn(data, 0.5, 0.4, 0.4);
  SearchResult found = found_in(data, {swing(Form::kCosine)});
  EXPECT_FALSE(complete_laws(data, data, found));
}

}  // namespace
}  // namespace ifog
