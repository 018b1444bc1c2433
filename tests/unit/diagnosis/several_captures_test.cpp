// SPDX-License-Identifier: Apache-2.0
// The room `checks`: what several captures of one sensor say of an effect together.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "filters/diagnosis/checks/between_captures.h"
#include "filters/diagnosis/checks/predicted_capture.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"

namespace ifog {
namespace {

constexpr std::size_t kBlocks = 1400;  // of a capture, two periods of the temperature's slow part

// Unit white noise and so much of the temperature in each capture.
BlockData captures_with(const std::vector<double>& slopes, std::uint64_t seed) {
  BlockData data = white_with_temperature(kBlocks * slopes.size(), seed);
  const Eigen::VectorXd noise = data.grid.error;
  data.grid = grid_of(std::vector<std::size_t>(slopes.size(), kBlocks));
  data.grid.error = noise;
  const Columns temperature = regressors(data, candidate_of(Form::kLinear));
  for (std::size_t r = 0; r < slopes.size(); ++r) {
    const BlockRange& record = data.grid.records[r];
    data.grid.error.segment(record.row(), record.rows()) +=
        slopes[r] * temperature.col(0).segment(record.row(), record.rows());
  }
  return data;
}

// Standard error of a slope in unit white noise beside a constant: one over the root of the squares about the
// mean.
double slope_error(const BlockData& data, std::size_t capture) {
  const BlockRange& record = data.grid.records[capture];
  const Eigen::VectorXd x =
      regressors(data, candidate_of(Form::kLinear)).col(0).segment(record.row(), record.rows());
  return 1.0 / std::sqrt((x.array() - x.mean()).square().sum());
}

TEST(BetweenCaptures, AnEffectIsFittedToEachByItself) {
  const BlockData data = captures_with({0.4, -0.3}, 11);
  const std::vector<ByCapture> found = compare_captures(data, {candidate_of(Form::kLinear)}, {});
  ASSERT_EQ(found.size(), 1U);
  ASSERT_EQ(found[0].records, (std::vector<std::size_t>{0, 1}));
  const std::vector<double> truth = {0.4, -0.3};
  for (std::size_t r = 0; r < 2; ++r) {
    EXPECT_NEAR(found[0].std_error[r] / slope_error(data, r), 1.0, 0.1);
    EXPECT_NEAR(found[0].value[r], truth[r], 4.0 * slope_error(data, r));
  }
  EXPECT_TRUE(found[0].changes());
  EXPECT_TRUE(found[0].changes_sign());
}

TEST(BetweenCaptures, TheSameEffectDoesNotChange) {
  const std::vector<ByCapture> found =
      compare_captures(captures_with({0.4, 0.4}, 12), {candidate_of(Form::kLinear)}, {});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_GT(found[0].p_value, 0.001);
  EXPECT_FALSE(found[0].changes());
  EXPECT_FALSE(found[0].changes_sign());
}

TEST(BetweenCaptures, OneCaptureIsComparedWithNothing) {
  EXPECT_TRUE(compare_captures(captures_with({0.4}, 13), {candidate_of(Form::kLinear)}, {}).empty());
}

// The first two predict for the third what is not there.
TEST(PredictedCapture, DeniesWhatItsOwnChannelDoesNotDo) {
  const BlockData data = captures_with({0.4, 0.4, 0.0}, 14);
  const std::optional<DeniedEffects> denied = denied_by_a_capture(data, {candidate_of(Form::kLinear)}, {});
  ASSERT_TRUE(denied.has_value());
  EXPECT_EQ(denied->effects, (std::vector<std::size_t>{0}));
  EXPECT_EQ(denied->record, 2U);
  EXPECT_NEAR(denied->share, 0.0, 4.0 * slope_error(data, 2) / 0.4);
}

TEST(PredictedCapture, DeniesNothingThatIsInAll) {
  EXPECT_FALSE(denied_by_a_capture(captures_with({0.4, 0.4, 0.4}, 15), {candidate_of(Form::kLinear)}, {}));
  EXPECT_FALSE(denied_by_a_capture(captures_with({0.4}, 16), {candidate_of(Form::kLinear)}, {}));
}

}  // namespace
}  // namespace ifog
