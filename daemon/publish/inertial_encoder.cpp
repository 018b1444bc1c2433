// SPDX-License-Identifier: Apache-2.0
#include "daemon/publish/inertial_encoder.h"

#include <algorithm>
#include <bot_core/ins_t.hpp>
#include <cstddef>
#include <ifog/imu_t.hpp>
#include <ifog/inertial_t.hpp>
#include <limits>
#include <microstrain/ins_t.hpp>

#include "daemon/publish/kvh_batch_encoder.h"
#include "daemon/publish/message_flags.h"
#include "daemon/publish/whole_sample.h"

namespace ifog {
namespace {

template <typename Message>
class Buffer {
 public:
  explicit Buffer(const Message& message) : bytes_(static_cast<std::size_t>(message.getEncodedSize())) {}
  std::span<const std::uint8_t> encode(const Message& message) noexcept {
    const int size = message.encode(bytes_.data(), 0, static_cast<int>(bytes_.size()));
    return {bytes_.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
  }

 private:
  std::vector<std::uint8_t> bytes_;
};

// Adds three axes to what waits of them.
void add(const Axes& from, bool waits, double* to) noexcept {
  for (std::size_t i = 0; i < kMaxAxes; ++i) to[i] = waits ? to[i] + from[i] : from[i];
}

void mean(const double* sum, const double* over_s, double* to) noexcept {
  for (std::size_t i = 0; i < kMaxAxes; ++i)
    to[i] = over_s[i] > 0.0 ? sum[i] / over_s[i] : std::numeric_limits<double>::quiet_NaN();
}

// ifog.imu_t and ifog.inertial_t.
template <typename Message>
class IncrementEncoder final : public InertialEncoder {
 public:
  explicit IncrementEncoder(int temperature_channel)
      : message_(), temperature_channel_(temperature_channel), buffer_(message_) {}

  std::span<const std::uint8_t> encode(const Increment& in, const ChainOutput& out) noexcept override {
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
    if constexpr (requires { message_.specific_force; }) {
      mean(message_.delta_theta, message_.turned_s, message_.rate);
      mean(message_.delta_v, message_.moved_s, message_.specific_force);
    }
    message_.temperature_degC = temperature_channel_ < 0
                                    ? std::numeric_limits<double>::quiet_NaN()
                                    : in.channel[static_cast<std::size_t>(temperature_channel_)];
    return buffer_.encode(message_);
  }
  void sent(bool good) noexcept override { waits_ = !good; }

 private:
  Message message_;
  int temperature_channel_;
  Buffer<Message> buffer_;
  bool waits_ = false;  // message_ holds what was not sent
};

// bot_core.ins_t and microstrain.ins_t. What a gyro does not know stays 0, as with their own publishers.
template <typename Message>
class InsEncoder final : public InertialEncoder {
 public:
  explicit InsEncoder(const SensorFacts& facts) : message_(), facts_(facts), buffer_(message_) {}

  std::span<const std::uint8_t> encode(const Increment& in, const ChainOutput& out) noexcept override {
    WholeSample sample;
    if (!whole_sample(in, out, facts_, sample)) return {};
    message_.utime = in.utime_ns / 1000;
    const std::int64_t device_ns = in.device_time_ns != -1 ? in.device_time_ns : in.utime_ns;
    if constexpr (std::is_same_v<decltype(message_.device_time), double>)
      message_.device_time = static_cast<double>(device_ns) * 1e-9;
    else
      message_.device_time = device_ns / 1000;
    std::copy(sample.rate_radps.begin(), sample.rate_radps.end(), message_.gyro);
    std::copy(sample.specific_force_mps2.begin(), sample.specific_force_mps2.end(), message_.accel);
    return buffer_.encode(message_);
  }

 private:
  Message message_;
  SensorFacts facts_;
  Buffer<Message> buffer_;
};

}  // namespace

std::unique_ptr<InertialEncoder> make_inertial_encoder(std::string_view type, const SensorFacts& facts) {
  if (type == kInertialType) return std::make_unique<IncrementEncoder<inertial_t>>(facts.temperature_channel);
  if (type == kInsType) return std::make_unique<InsEncoder<bot_core::ins_t>>(facts);
  if (type == kMicrostrainType) return std::make_unique<InsEncoder<microstrain::ins_t>>(facts);
  if (type == kKvhBatchType) return std::make_unique<KvhBatchEncoder>(facts);
  return std::make_unique<IncrementEncoder<imu_t>>(facts.temperature_channel);
}

}  // namespace ifog
