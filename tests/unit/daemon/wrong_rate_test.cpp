// SPDX-License-Identifier: Apache-2.0
#include "daemon/health/wrong_rate.h"

#include <gtest/gtest.h>

namespace ifog {
namespace {

struct Case {
  double rate_hz;
  const char* words;
};

// The intervals in use are 1/200 s, so an angle is wrong by f / 200 - 1.
TEST(WrongRate, TheFiguresAreOfTheIntervalsInUse) {
  for (const auto& [rate_hz, words] : {Case{400.0, "100 % too large"}, Case{220.0, "10 % too large"},
                                       Case{180.0, "10 % too small"}, Case{100.0, "50 % too small"}}) {
    const std::string said = wrong_rate_in_words(200.0, 200.0 / rate_hz - 1.0, rate_hz + 1.0);
    EXPECT_NE(said.find(words), std::string::npos) << rate_hz << ": " << said;
  }
  EXPECT_EQ(wrong_rate_in_words(200.0, 200.0 / 220.0 - 1.0, 221.0),
            "samples come at 220 Hz by their arrival, expected 200 Hz: intervals, and angles made of a rate, "
            "are 10 % too large");
}

// The fit follows a period to half and to twice the nominal one.
TEST(WrongRate, BeyondWhatTheFitFollowsTheSamplesAreCounted) {
  for (const auto& [rate_hz, words] :
       {Case{600.0,
             "come at 600 Hz by their arrival, expected 200 Hz: intervals, and angles made of a rate, "
             "are 200 % too large"},
        Case{800.0, "300 % too large"}, Case{50.0, "come at 50 Hz"}, Case{50.0, "75 % too small"}}) {
    const std::string said = wrong_rate_in_words(200.0, rate_hz > 200.0 ? -0.5 : 1.0, rate_hz);
    EXPECT_NE(said.find(words), std::string::npos) << rate_hz << ": " << said;
  }
  EXPECT_NE(wrong_rate_in_words(200.0, -0.5, 0.0).find("come at 400 Hz"), std::string::npos);
}

}  // namespace
}  // namespace ifog
