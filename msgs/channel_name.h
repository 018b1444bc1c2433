// SPDX-License-Identifier: Apache-2.0
// The LCM channels of a sensor: rates on IFOG_<NAME>, status and increments on that name with a suffix. The
// only definition of this rule.
#pragma once

#include <array>
#include <string_view>
#include <utility>

namespace ifog {

enum class ChannelContent { rate, status, imu, foreign };

struct ChannelName {
  ChannelContent content = ChannelContent::foreign;
  std::string_view sensor;  // in capitals
};

inline constexpr std::string_view kChannelPrefix = "IFOG_", kStatusEnding = "_STATUS", kImuEnding = "_IMU";

// Content of the channel if the daemon publishes it.
inline ChannelName channel_name(std::string_view channel) {
  if (!channel.starts_with(kChannelPrefix)) return {};
  channel.remove_prefix(kChannelPrefix.size());
  constexpr std::array kEndings{std::pair{kStatusEnding, ChannelContent::status},
                                std::pair{kImuEnding, ChannelContent::imu}};
  for (const auto& [ending, content] : kEndings)
    if (channel.size() > ending.size() && channel.ends_with(ending))
      return {content, channel.substr(0, channel.size() - ending.size())};
  return {ChannelContent::rate, channel};
}

}  // namespace ifog
