// SPDX-License-Identifier: Apache-2.0
#include "daemon/publish/inertial_encoder.h"

#include <gtest/gtest.h>

#include <bot_core/kvh_raw_imu_batch_t.hpp>
#include <ifog/imu_t.hpp>
#include <limits>
#include <map>

namespace ifog {
namespace {

TEST(InertialEncoder, SamplesThatWaitBeyondWhatTheirFieldHoldsAreItsMost) {
  const auto encoder = make_inertial_encoder(kImuType, SensorFacts{});
  Increment increment;
  increment.samples = 1'500'000'000;
  const ChainOutput out;
  imu_t message;
  for (const std::int32_t expected : {1'500'000'000, std::numeric_limits<std::int32_t>::max()}) {
    const auto bytes = encoder->encode(increment, out);
    ASSERT_GT(message.decode(bytes.data(), 0, static_cast<int>(bytes.size())), 0);
    EXPECT_EQ(message.merged, expected);
    encoder->sent(false);
  }
}

// Thirty samples, of which three came merged and one had an invalid axis: every packet has a period's angle,
// the counts are those of the device, and the sum is what was turned.
TEST(InertialEncoder, MergedSamplesAreAsManyPacketsOfABatch) {
  SensorFacts facts;
  facts.acceleration_channel = {0, 1, 2};
  const auto encoder = make_inertial_encoder(kKvhBatchType, facts);
  std::map<std::int64_t, double> turned;
  for (std::uint64_t n = 1; n <= 30; ++n) {
    if (n == 10 || n == 11) continue;
    Increment in;
    ChainOutput out;
    in.sequence = n;
    in.samples = n == 12 ? 3 : 1;
    in.utime_ns = static_cast<std::int64_t>(n) * 1'000'000;
    in.covered_s.fill(n == 20 ? 0.0 : 0.001 * in.samples);
    in.moved_s = in.covered_s;
    in.delta_v_mps.fill(9.81 * in.moved_s[0]);
    out.delta_theta_rad.fill(0.5 * in.covered_s[0]);
    const auto bytes = encoder->encode(in, out);
    EXPECT_EQ(bytes.empty(), n == 20);
    bot_core::kvh_raw_imu_batch_t batch;
    if (bytes.empty()) continue;
    ASSERT_GT(batch.decode(bytes.data(), 0, static_cast<int>(bytes.size())), 0);
    EXPECT_EQ(batch.raw_imu.front().packet_count, n);
    for (const auto& packet : batch.raw_imu) {
      EXPECT_NEAR(packet.delta_rotation[1], 0.0005, 1e-12);
      EXPECT_NEAR(packet.linear_acceleration[2], 9.81, 1e-9);
      EXPECT_EQ(packet.utime, packet.packet_count * 1000);
      turned[packet.packet_count] = packet.delta_rotation[0];
    }
  }
  EXPECT_EQ(turned.size(), 29U);
  EXPECT_EQ(turned.count(20), 0U);
}

}  // namespace
}  // namespace ifog
