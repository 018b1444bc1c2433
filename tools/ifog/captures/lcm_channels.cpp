// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/lcm_channels.h"

#include <ifog/decode.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "drivers/capture/column_names.h"

namespace ifog::tools {
namespace {

// A status says the same measurement again, older, until a new one comes; its age is known to some tens of
// ms.
constexpr double kAnother_s = 0.5;

// Names come from the network: one that is a rate's or no word would make another file of it.
bool good_name(const std::string& name) {
  std::string axis;
  return !name.empty() && name != "time_s" && !axis_of(name, "rate", axis) &&
         !axis_of(name, "reference_rate", axis) && name.find('_') != std::string::npos &&
         std::all_of(name.begin(), name.end(),
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
}

}  // namespace

void LcmChannels::put(const std::string& name, double value, double measured_s, bool of_status) {
  if (!good_name(name) || !std::isfinite(value)) return;
  Channel& channel = channels_[name];
  // The daemon's own view of a channel is scaled and held to its limits: it stands over a raw message.
  if (of_status && !channel.of_status) channel = {};
  if (channel.of_status && !of_status) return;
  channel.of_status = of_status;
  if (channel.known && value == channel.last && measured_s - channel.measured_s < kAnother_s) return;
  channel.known = true;
  channel.last = value;
  channel.measured_s = measured_s;
  channel.by_row[row_] = value;
}

void LcmChannels::take(const std::string& channel, std::span<const std::uint8_t> message) {
  if (channel == status_) {
    status_t status;
    if (!decode_message(message.data(), message.size(), status)) return;
    for (std::size_t i = 0; i < status.channel_name.size(); ++i)
      if (std::isfinite(status.channel_age_s[i]))
        put(status.channel_name[i], status.channel_value[i],
            static_cast<double>(status.utime) * 1e-6 - status.channel_age_s[i], true);
    return;
  }
  channel_t one;
  if (!channel.starts_with("IFOG_") && decode_message(message.data(), message.size(), one))
    put(one.name, one.value, std::numeric_limits<double>::infinity(), false);
}

void LcmChannels::end_row() { ++row_; }

std::vector<CaptureColumn> LcmChannels::columns() const {
  std::vector<CaptureColumn> out;
  for (const auto& [name, channel] : channels_) {
    CaptureColumn column{name, std::vector<double>(row_, std::numeric_limits<double>::quiet_NaN())};
    for (const auto& [row, value] : channel.by_row)
      if (row < row_) column.values[row] = value;
    if (!std::all_of(column.values.begin(), column.values.end(), [](double v) { return std::isnan(v); }))
      out.push_back(std::move(column));
  }
  return out;
}

}  // namespace ifog::tools
