// SPDX-License-Identifier: Apache-2.0
// Messages that carry rates and are no ifog.rate_t: of other programs on LCM, see msgs/peers, and ours with
// specific force. A type is known by its hash.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

namespace ifog::tools {

struct PeerSample {
  enum class Kind { rate, delta, angle };
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

  Kind kind = Kind::rate;
  std::int64_t utime = 0;                                     // µs since the epoch
  std::int64_t count = 0;                                     // the sensor's own, where the type has one
  std::int64_t device_ns = -1;                                // the device's clock; −1: none
  std::int32_t flags = 0, merged = 1;                         // as in rate_t
  std::array<double, 3> value{kUnknown, kUnknown, kUnknown};  // rad/s, or rad since the sample before, or rad
  std::array<double, 3> specific_force_mps2{kUnknown, kUnknown, kUnknown};
  double temperature_degC = kUnknown;
};

struct PeerType {
  std::string_view name;  // "bot_core.ins_t"
  std::int64_t hash;
  std::size_t axes;  // 1 or 3
  bool specific_force, temperature;
  enum class Count { none, whole, repeats } count;  // repeats: messages bring samples again
  std::int64_t modulus;                             // the count rolls over after so many; 0: it does not
  // The samples of a message, the oldest first. False: it is none of the type.
  bool (*unpack)(std::span<const std::uint8_t> message, std::vector<PeerSample>& out);
};

// That of the message; null: none of these.
const PeerType* peer_type(std::span<const std::uint8_t> message);

}  // namespace ifog::tools
