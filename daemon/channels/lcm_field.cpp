// SPDX-License-Identifier: Apache-2.0
#include "daemon/channels/lcm_field.h"

#include <ifog/decode.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "drivers/ifog/quoted.h"
#include "filters/settings/axes.h"

namespace ifog {
namespace {

template <typename Message, typename Field>
struct Named {
  std::string_view name;
  Field Message::*field;
};

using OfRate = Named<rate_t, std::vector<double>>;
constexpr std::array kOfRate{OfRate{"raw", &rate_t::raw}, OfRate{"compensated", &rate_t::compensated},
                             OfRate{"denoised", &rate_t::denoised}};
using OfStatusByAxis = Named<status_t, std::vector<double>>;
constexpr std::array kOfStatusByAxis{OfStatusByAxis{"nis_mean", &status_t::nis_mean},
                                     OfStatusByAxis{"whiteness", &status_t::whiteness},
                                     OfStatusByAxis{"measurement_noise", &status_t::measurement_noise}};
using OfStatus = Named<status_t, double>;
constexpr std::array kOfStatus{OfStatus{"input_rate_hz", &status_t::input_rate_hz},
                               OfStatus{"output_rate_hz", &status_t::output_rate_hz},
                               OfStatus{"clock_offset_ppm", &status_t::clock_offset_ppm},
                               OfStatus{"latency_p50_us", &status_t::latency_p50_us},
                               OfStatus{"latency_p99_us", &status_t::latency_p99_us},
                               OfStatus{"latency_max_us", &status_t::latency_max_us}};
constexpr std::string_view kChannelValue = "channel_value";

// The table's row of that name, or null.
template <typename Table>
auto find(const Table& table, std::string_view name) {
  const auto found =
      std::find_if(table.begin(), table.end(), [&](const auto& row) { return row.name == name; });
  return found == table.end() ? nullptr : &*found;
}

}  // namespace

LcmField::LcmField(const std::string& text) : name_(text.substr(0, text.find('['))) {
  if (name_.size() == text.size()) return;
  within_ = text.substr(name_.size() + 1);
  const bool closed = !within_.empty() && within_.back() == ']';
  if (closed) within_.pop_back();
  if (closed && name_ == kChannelValue && !within_.empty()) return;
  const bool by_axis = find(kOfRate, name_) != nullptr || find(kOfStatusByAxis, name_) != nullptr;
  const bool axis = within_.size() == 1 && within_[0] >= '0' && within_[0] < '0' + kMaxAxes;
  if (!closed || !by_axis || !axis)
    throw std::runtime_error(
        "sensor.channel.field = \"" + printable(text) +
        "\": expected the name in an ifog.channel_t; raw[i], compensated[i], denoised[i] of an ifog.rate_t; "
        "channel_value[NAME], nis_mean[i], whiteness[i], measurement_noise[i] or a number of an "
        "ifog.status_t; i = 0 ... 2");
  axis_ = within_[0] - '0';
}

bool is_message(std::span<const std::uint8_t> bytes) {
  channel_t channel{};
  rate_t rate{};
  status_t status{};
  return decode_message(bytes, channel) || decode_message(bytes, rate) || decode_message(bytes, status);
}

bool LcmField::read(std::span<const std::uint8_t> message, double& value, std::int64_t& utime) const {
  if (find(kOfRate, name_) != nullptr && axis_ >= 0) return read_rate(message, value, utime);
  channel_t channel{};
  if (within_.empty() && decode_message(message, channel)) {
    if (channel.name != name_) return false;
    value = channel.value;
    utime = channel.utime;
    return true;
  }
  return read_status(message, value, utime);
}

bool LcmField::read_rate(std::span<const std::uint8_t> message, double& value, std::int64_t& utime) const {
  rate_t rate{};
  if (!decode_message(message, rate) || axis_ >= rate.axes) return false;
  value = (rate.*find(kOfRate, name_)->field)[static_cast<std::size_t>(axis_)];
  utime = rate.utime;
  return true;
}

bool LcmField::read_status(std::span<const std::uint8_t> message, double& value, std::int64_t& utime) const {
  status_t status{};
  if (!decode_message(message, status)) return false;
  utime = std::max<std::int64_t>(status.utime, 0);
  if (name_ == kChannelValue) {
    const auto found = std::find(status.channel_name.begin(), status.channel_name.end(), within_);
    if (found == status.channel_name.end()) return false;
    const auto index = static_cast<std::size_t>(found - status.channel_name.begin());
    value = status.channel_value[index];
    // What that sensor holds is as old as it says.
    const double age_s = status.channel_age_s[index];
    constexpr double kOldest_s = 1e9;  // beyond it nothing is worth having; and it fits the µs
    if (!std::isfinite(value) || !(age_s >= 0.0 && age_s < kOldest_s)) return false;
    utime -= static_cast<std::int64_t>(age_s * 1e6);
    return true;
  }
  if (axis_ >= 0) {
    if (axis_ >= status.axes) return false;
    value = (status.*find(kOfStatusByAxis, name_)->field)[static_cast<std::size_t>(axis_)];
    return true;
  }
  const auto* const row = find(kOfStatus, name_);
  if (row == nullptr) return false;
  value = status.*row->field;
  return true;
}

}  // namespace ifog
