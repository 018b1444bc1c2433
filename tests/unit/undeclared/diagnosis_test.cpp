// A fixed handful of the bench's sensors: enough to notice when the diagnosis breaks, not to measure it. What
// it is worth is measured by score_undeclared.
#include <gtest/gtest.h>

#include <iostream>

#include "tests/bench/undeclared/project_diagnosis.h"
#include "tests/bench/undeclared/tally.h"

namespace {

using namespace ifog::undeclared;

TEST(UndeclaredDiagnosis, FindsWhatIsHiddenAndNothingElse) {
  std::vector<Score> scores;
  std::uint64_t seed = 7000;
  for (const Kind kind : kinds_with_effect())
    scores.push_back(score(draw_sensor(seed++, kind, 40.0), project_diagnosis()));
  print_failures(std::cout, scores);
  const Totals t = total(scores);
  EXPECT_GE(t.right, t.sensors - 1);
  EXPECT_LE(t.extra, 1);
  EXPECT_EQ(t.made_worse, 0);
}

TEST(UndeclaredDiagnosis, FindsNothingWhereNothingIs) {
  std::vector<Score> scores;
  for (std::uint64_t seed = 8000; seed < 8016; ++seed)
    scores.push_back(score(draw_sensor(seed, seed % 4 == 3 ? Kind::kLookalike : Kind::kNothing, 0.0),
                           project_diagnosis()));
  print_failures(std::cout, scores);
  EXPECT_EQ(total(scores).false_alarms, 0);
}

// Two short captures, each with a switch-on bias of its own, say what neither says as well alone.
TEST(UndeclaredDiagnosis, SeveralCapturesAreFittedTogether) {
  const Score s = score(draw_sensor(9000, Kind::kTemperatureLinear, 40.0, 2), project_diagnosis());
  EXPECT_TRUE(s.right()) << s.names;
  EXPECT_EQ(s.extra, 0) << s.names;
}

}  // namespace
