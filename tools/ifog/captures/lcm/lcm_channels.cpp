// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/lcm/lcm_channels.h"

#include <ifog/decode.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <utility>

#include "drivers/capture/columns/column_names.h"

namespace ifog::tools {
namespace {

// A status repeats a measurement, with a growing age, until there is a new one. Its age is uncertain by some
// 10 ms.
constexpr double kAnother_s = 0.5;

// Names come from the network; a rate's name or one with other characters would corrupt the file.
bool good_name(const std::string& name) {
  std::string axis;
  return !name.empty() && name != "time_s" && !axis_of(name, "rate", axis) &&
         !axis_of(name, "reference_rate", axis) && name.find('_') != std::string::npos &&
         std::ranges::all_of(name, [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
}

}  // namespace

void LcmChannels::unpack(const std::string& channel, std::span<const std::uint8_t> message,
                         const std::function<void(const Said&)>& sink) const {
  const auto say = [&](const std::string& name, double value, double measured_s, bool of_status) {
    if (good_name(name) && std::isfinite(value)) sink({name, value, measured_s, of_status});
  };
  if (channel == status_) {
    status_t status;
    if (!decode_message(message.data(), message.size(), status)) return;
    for (std::size_t i = 0; i < status.channel_name.size(); ++i)
      if (std::isfinite(status.channel_age_s[i]))
        say(status.channel_name[i], status.channel_value[i],
            static_cast<double>(status.utime) * 1e-6 - status.channel_age_s[i], true);
    return;
  }
  channel_t one;
  if (!channel.starts_with("IFOG_") && decode_message(message.data(), message.size(), one))
    say(one.name, one.value, std::numeric_limits<double>::infinity(), false);
}

void LcmChannels::look_at(const std::string& channel, std::span<const std::uint8_t> message) {
  unpack(channel, message, [&](const Said& said) {
    Channel now;
    now.of_status = said.of_status;
    now.first_row = rows_;
    const auto [at, first] = channels_.try_emplace(said.name, now);
    if (!first && said.of_status && !at->second.of_status) at->second = now;
  });
}

std::vector<std::string> LcmChannels::settle(const std::vector<std::string>& without) {
  std::erase_if(channels_, [&](const auto& entry) { return entry.second.first_row >= rows_; });
  for (const std::string& name : without) channels_.erase(name);
  std::vector<std::string> names;
  for (const auto& [name, channel] : channels_) names.push_back(name);
  return names;
}

void LcmChannels::take(const std::string& channel, std::span<const std::uint8_t> message) {
  unpack(channel, message, [&](const Said& said) {
    const auto found = channels_.find(said.name);
    if (found == channels_.end() || found->second.of_status != said.of_status) return;
    Channel& mine = found->second;
    if (mine.known && said.value == mine.last && said.measured_s - mine.measured_s < kAnother_s) return;
    mine.known = true;
    mine.last = said.value;
    mine.measured_s = said.measured_s;
    mine.now = said.value;
  });
}

void LcmChannels::end_row(std::vector<double>& values) {
  for (auto& [name, channel] : channels_)
    values.push_back(
        std::exchange(channel.now, std::nullopt).value_or(std::numeric_limits<double>::quiet_NaN()));
}

}  // namespace ifog::tools
