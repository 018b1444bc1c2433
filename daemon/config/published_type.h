// SPDX-License-Identifier: Apache-2.0
// Types published for each sample besides rate_t.
#pragma once

#include <string>
#include <string_view>

namespace ifog {

// Names of the types in the configuration.
inline constexpr std::string_view kImuType = "ifog.imu_t", kInertialType = "ifog.inertial_t",
                                  kInsType = "bot_core.ins_t", kMicrostrainType = "microstrain.ins_t",
                                  kKvhBatchType = "bot_core.kvh_raw_imu_batch_t";

// A type and its LCM channel.
struct PublishedType {
  std::string type, channel;

  bool operator==(const PublishedType&) const = default;
};

}  // namespace ifog
