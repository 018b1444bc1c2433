// SPDX-License-Identifier: Apache-2.0
#include "daemon/health/counted_rate.h"
#include "daemon/health/wrong_rate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace ifog {
namespace {

// Read once a second, of a sensor slower and quicker than that.
TEST(CountedRate, IsThatOfTheSensorHoweverSlowItIs) {
  for (const double rate_hz : {0.02, 0.1, 0.37, 0.9, 1.0, 3.3, 50.0, 1000.0}) {
    CountedRate rate;
    double shown_hz = 0.0;
    const auto seconds = static_cast<int>(std::ceil(40.0 / rate_hz)) + 20;
    for (int s = 1; s <= seconds; ++s) {
      shown_hz = rate.of(static_cast<std::int64_t>(rate_hz * s + 0.5), 1.0, rate_hz);
      // A reading is a second: of ten samples that came, one of ten periods.
      if (s > 25.0 / rate_hz) {
        EXPECT_NEAR(shown_hz, rate_hz, 0.12 * rate_hz) << rate_hz << ", " << s;
      }
    }
    const auto last = static_cast<std::int64_t>(rate_hz * seconds + 0.5);
    for (int s = 0; s < 4.0 / rate_hz + 4.0; ++s) shown_hz = rate.of(last, 1.0, rate_hz);
    EXPECT_EQ(shown_hz, 0.0) << rate_hz << " Hz, silent";
  }
}

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
