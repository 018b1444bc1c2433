// SPDX-License-Identifier: Apache-2.0
#include "daemon/publish/imu_encoder.h"

#include <algorithm>
#include <limits>

#include "daemon/publish/message_flags.h"

namespace ifog {

ImuEncoder::ImuEncoder(int temperature_channel)
    : message_(),
      temperature_channel_(temperature_channel),
      buffer_(static_cast<std::size_t>(message_.getEncodedSize())) {}

std::span<const std::uint8_t> ImuEncoder::encode(const Increment& in, const ChainOutput& out) noexcept {
  message_.utime = in.utime_ns / 1000;
  message_.seq = static_cast<std::int64_t>(in.sequence);
  message_.sensor_time_ns = in.device_time_ns;
  message_.dt = in.dt_s;
  message_.merged = static_cast<std::int32_t>(in.samples);
  message_.flags = message_flags(in, out);
  message_.status = static_cast<std::int32_t>(in.status);
  std::copy_n(out.delta_theta_rad.begin(), kMaxAxes, message_.delta_theta);
  std::copy_n(in.covered_s.begin(), kMaxAxes, message_.turned_s);
  std::copy_n(in.delta_v_mps.begin(), kMaxAxes, message_.delta_v);
  std::copy_n(in.moved_s.begin(), kMaxAxes, message_.moved_s);
  message_.temperature_degC = temperature_channel_ < 0
                                  ? std::numeric_limits<double>::quiet_NaN()
                                  : in.channel[static_cast<std::size_t>(temperature_channel_)];
  const int size = message_.encode(buffer_.data(), 0, static_cast<int>(buffer_.size()));
  return {buffer_.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
}

}  // namespace ifog
