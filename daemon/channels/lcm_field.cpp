// SPDX-License-Identifier: Apache-2.0
#include "daemon/channels/lcm_field.h"

#include <ifog/decode.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

namespace ifog {
namespace {

template <typename Message, typename Field>
struct Named {
  std::string_view name;
  Field Message::*field;
};

using OfRate = Named<rate_t, std::vector<double>>;
constexpr std::array kOfRate{OfRate{kRateFields[0], &rate_t::raw},
                             OfRate{kRateFields[1], &rate_t::compensated},
                             OfRate{kRateFields[2], &rate_t::denoised}};
using OfStatusByAxis = Named<status_t, std::vector<double>>;
constexpr std::array kOfStatusByAxis{OfStatusByAxis{kStatusAxisFields[0], &status_t::nis_mean},
                                     OfStatusByAxis{kStatusAxisFields[1], &status_t::whiteness},
                                     OfStatusByAxis{kStatusAxisFields[2], &status_t::measurement_noise}};
using OfStatus = Named<status_t, double>;
constexpr std::array kOfStatus{OfStatus{"input_rate_hz", &status_t::input_rate_hz},
                               OfStatus{"output_rate_hz", &status_t::output_rate_hz},
                               OfStatus{"clock_offset_ppm", &status_t::clock_offset_ppm},
                               OfStatus{"latency_p50_us", &status_t::latency_p50_us},
                               OfStatus{"latency_p99_us", &status_t::latency_p99_us},
                               OfStatus{"latency_max_us", &status_t::latency_max_us}};

// The table's row of that name, or null.
template <typename Table>
auto find(const Table& table, std::string_view name) {
  const auto found =
      std::find_if(table.begin(), table.end(), [&](const auto& row) { return row.name == name; });
  return found == table.end() ? nullptr : &*found;
}

}  // namespace

bool is_message(std::span<const std::uint8_t> bytes) {
  channel_t channel{};
  rate_t rate{};
  status_t status{};
  return decode_message(bytes, channel) || decode_message(bytes, rate) || decode_message(bytes, status);
}

bool LcmField::read(std::span<const std::uint8_t> message, double& value, std::int64_t& utime) const {
  if (field_.of_rate()) return read_rate(message, value, utime);
  channel_t channel{};
  if (field_.within.empty() && decode_message(message, channel)) {
    if (channel.name != field_.name) return false;
    value = channel.value;
    utime = channel.utime;
    return true;
  }
  return read_status(message, value, utime);
}

bool LcmField::read_rate(std::span<const std::uint8_t> message, double& value, std::int64_t& utime) const {
  rate_t rate{};
  if (!decode_message(message, rate) || field_.axis >= rate.axes) return false;
  value = (rate.*find(kOfRate, field_.name)->field)[static_cast<std::size_t>(field_.axis)];
  utime = rate.utime;
  return true;
}

bool LcmField::read_status(std::span<const std::uint8_t> message, double& value, std::int64_t& utime) const {
  status_t status{};
  if (!decode_message(message, status)) return false;
  utime = std::max<std::int64_t>(status.utime, 0);
  if (field_.name == kChannelValueField) {
    const auto found = std::find(status.channel_name.begin(), status.channel_name.end(), field_.within);
    if (found == status.channel_name.end()) return false;
    const auto index = static_cast<std::size_t>(found - status.channel_name.begin());
    value = status.channel_value[index];
    // The value has the age given by that sensor.
    const double age_s = status.channel_age_s[index];
    constexpr double kOldest_s = 1e9;  // older values are useless, and it fits into µs
    if (!std::isfinite(value) || !(age_s >= 0.0 && age_s < kOldest_s)) return false;
    utime -= static_cast<std::int64_t>(age_s * 1e6);
    return true;
  }
  if (field_.axis >= 0) {
    if (field_.axis >= status.axes) return false;
    value = (status.*find(kOfStatusByAxis, field_.name)->field)[static_cast<std::size_t>(field_.axis)];
    return true;
  }
  const auto* const row = find(kOfStatus, field_.name);
  if (row == nullptr) return false;
  value = status.*row->field;
  return true;
}

}  // namespace ifog
