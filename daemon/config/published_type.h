// SPDX-License-Identifier: Apache-2.0
// What is published of each sample besides rate_t.
#pragma once

#include <string>
#include <string_view>

namespace ifog {

// The types, by the names that the configuration has for them.
inline constexpr std::string_view kImuType = "ifog.imu_t", kInertialType = "ifog.inertial_t",
                                  kInsType = "bot_core.ins_t", kMicrostrainType = "microstrain.ins_t",
                                  kKvhBatchType = "bot_core.kvh_raw_imu_batch_t";

// A type and the LCM channel that carries it.
struct PublishedType {
  std::string type, channel;

  bool operator==(const PublishedType&) const = default;
};

}  // namespace ifog
