// SPDX-License-Identifier: Apache-2.0
#include "daemon/publish/imu_encoder.h"

#include <gtest/gtest.h>

#include <limits>

namespace ifog {
namespace {

TEST(ImuEncoder, SamplesThatWaitBeyondWhatTheirFieldHoldsAreItsMost) {
  ImuEncoder encoder(-1);
  Increment increment;
  increment.samples = 1'500'000'000;
  const ChainOutput out;
  imu_t message;
  for (const std::int32_t expected : {1'500'000'000, std::numeric_limits<std::int32_t>::max()}) {
    const auto bytes = encoder.encode(increment, out);
    ASSERT_GT(message.decode(bytes.data(), 0, static_cast<int>(bytes.size())), 0);
    EXPECT_EQ(message.merged, expected);
    encoder.sent(false);
  }
}

}  // namespace
}  // namespace ifog
