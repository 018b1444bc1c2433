// SPDX-License-Identifier: Apache-2.0
#include "daemon/health/counted_rate.h"

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

}  // namespace
}  // namespace ifog
