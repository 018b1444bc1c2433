// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/processor_share.h"

#include <gtest/gtest.h>

namespace ifog {
namespace {

constexpr std::int64_t kMs = 1'000'000;

// Turns of work_ms every period_ms, or as soon as it may. The part of a minute that was work.
double share_of_a_minute(std::int64_t work_ms, std::int64_t period_ms) {
  ProcessorShare share;
  std::int64_t now = 5'000 * kMs, used = 77 * kMs;
  const std::int64_t begin = now, begin_used = used;
  while (now - begin < 60'000 * kMs) {
    const std::int64_t done = now + work_ms * kMs;
    used += work_ms * kMs;
    now = std::max(done + share.rest_ns(done, [&] { return used; }), now + period_ms * kMs);
  }
  return static_cast<double>(used - begin_used) / static_cast<double>(now - begin);
}

TEST(ProcessorShare, ABabblerKeepsToThreeQuartersAndOthersAreNotHeldUp) {
  EXPECT_NEAR(share_of_a_minute(1, 1), 0.75, 0.01);
  EXPECT_NEAR(share_of_a_minute(30, 31), 0.75, 0.03);
  EXPECT_NEAR(share_of_a_minute(7, 10), 0.7, 1e-3);
  EXPECT_NEAR(share_of_a_minute(1, 5), 0.2, 1e-3);
}

TEST(ProcessorShare, ABurstAfterASilenceIsReadAtOnce) {
  ProcessorShare share;
  std::int64_t used = 0;
  const auto so_far = [&] { return used; };
  EXPECT_EQ(share.rest_ns(1 * kMs, so_far), 0);
  const std::int64_t begin = 3'600'000 * kMs;
  for (int n = 0; n < 100; ++n, used += kMs) EXPECT_EQ(share.rest_ns(begin + n * kMs, so_far), 0) << n;
  EXPECT_GT(share.rest_ns(begin + 100 * kMs, so_far), 0);
}

// Four seconds that passed in one turn are no work: the process was stopped.
TEST(ProcessorShare, AHaltIsNotPaidForAfterwards) {
  ProcessorShare share;
  EXPECT_EQ(share.rest_ns(1 * kMs, [] { return std::int64_t{0}; }), 0);
  EXPECT_LT(share.rest_ns(4'000 * kMs, [] { return 3'999 * kMs; }), 34 * kMs);
}

}  // namespace
}  // namespace ifog
