// SPDX-License-Identifier: Apache-2.0
// The last packets of the sensor as a bot_core.kvh_raw_imu_batch_t, one batch a sample: a packet is in fifteen
// datagrams, and lost where all of them are.
#pragma once

#include <bot_core/kvh_raw_imu_batch_t.hpp>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "daemon/publish/inertial_encoder.h"

namespace ifog {

class KvhBatchEncoder final : public InertialEncoder {
 public:
  static constexpr std::size_t kPackets = 15;  // as the Atlas robot's driver sends

  explicit KvhBatchEncoder(const SensorFacts& facts);
  std::span<const std::uint8_t> encode(const Increment& in, const ChainOutput& out) noexcept override;

 private:
  SensorFacts facts_;
  bot_core::kvh_raw_imu_batch_t message_;
  std::vector<std::uint8_t> buffer_;
};

}  // namespace ifog
