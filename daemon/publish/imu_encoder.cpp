// SPDX-License-Identifier: Apache-2.0
#include "daemon/publish/imu_encoder.h"

#include <algorithm>
#include <cstddef>
#include <ifog/rate_t.hpp>
#include <limits>

#include "daemon/publish/message_flags.h"

namespace ifog {
namespace {

// Adds three axes to what waits of them.
void add(const Axes& from, bool waits, double* to) noexcept {
  for (std::size_t i = 0; i < kMaxAxes; ++i) to[i] = waits ? to[i] + from[i] : from[i];
}

}  // namespace

ImuEncoder::ImuEncoder(int temperature_channel)
    : message_(),
      temperature_channel_(temperature_channel),
      buffer_(static_cast<std::size_t>(message_.getEncodedSize())) {}

std::span<const std::uint8_t> ImuEncoder::encode(const Increment& in, const ChainOutput& out) noexcept {
  message_.utime = in.utime_ns / 1000;
  message_.seq = static_cast<std::int64_t>(in.sequence);
  message_.sensor_time_ns = in.device_time_ns;
  message_.dt = waits_ ? message_.dt + in.dt_s : in.dt_s;
  const std::int64_t waiting = waits_ ? message_.merged : 0;
  message_.merged = static_cast<std::int32_t>(
      std::min<std::int64_t>(waiting + in.samples, std::numeric_limits<std::int32_t>::max()));
  message_.flags = message_flags(in, out) | (waits_ ? message_.flags | rate_t::FLAG_MERGED : 0);
  message_.status = static_cast<std::int32_t>(in.status);
  add(out.delta_theta_rad, waits_, message_.delta_theta);
  add(in.covered_s, waits_, message_.turned_s);
  add(in.delta_v_mps, waits_, message_.delta_v);
  add(in.moved_s, waits_, message_.moved_s);
  message_.temperature_degC = temperature_channel_ < 0
                                  ? std::numeric_limits<double>::quiet_NaN()
                                  : in.channel[static_cast<std::size_t>(temperature_channel_)];
  const int size = message_.encode(buffer_.data(), 0, static_cast<int>(buffer_.size()));
  return {buffer_.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
}

}  // namespace ifog
