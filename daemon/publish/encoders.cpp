// SPDX-License-Identifier: Apache-2.0
#include "daemon/publish/encoders.h"

#include <algorithm>
#include <bot_core/ins_t.hpp>
#include <bot_core/kvh_raw_imu_batch_t.hpp>
#include <cmath>
#include <cstddef>
#include <ifog/imu_t.hpp>
#include <ifog/inertial_t.hpp>
#include <limits>
#include <microstrain/ins_t.hpp>

namespace ifog {
namespace {

constexpr std::size_t kLongestIdentity = 64;

// Flags of rate_t and imu_t from the chain's flags.
std::int32_t message_flags(const Increment& in, const ChainOutput& out) noexcept {
  std::int32_t flags = 0;
  const auto pass = [&flags](std::uint32_t set, std::uint32_t bit, std::int32_t flag) {
    if ((set & bit) != 0) flags |= flag;
  };
  pass(in.flags, kGapBefore, rate_t::FLAG_GAP);
  pass(in.flags, kMerged, rate_t::FLAG_MERGED);
  pass(in.flags, kInvalid, rate_t::FLAG_INVALID);
  pass(in.flags, kClockStep, rate_t::FLAG_CLOCK_STEP);
  pass(in.flags, kSensorClockSet, rate_t::FLAG_SENSOR_CLOCK_SET);
  pass(in.flags, kBeyondStated, rate_t::FLAG_BEYOND_STATED);
  pass(in.flags, kAtFullScale, rate_t::FLAG_SATURATED);
  pass(out.compensator_flags, kStaleChannel | kNoChannelYet, rate_t::FLAG_STALE_CHANNEL);
  pass(out.compensator_flags, kOutOfRange, rate_t::FLAG_OUT_OF_RANGE);
  pass(out.compensator_flags, kRampUnknown, rate_t::FLAG_RAMP_UNKNOWN);
  pass(out.flags, kNoiseUnknown, rate_t::FLAG_NOISE_UNKNOWN);
  pass(out.flags, kFilterReset, rate_t::FLAG_FILTER_RESET);
  pass(out.flags, kNotCompensated, rate_t::FLAG_NOT_COMPENSATED);
  pass(out.estimate.flags, kGated, rate_t::FLAG_GATED);
  pass(out.estimate.flags, kManoeuvre, rate_t::FLAG_MANOEUVRE);
  pass(out.estimate.flags, kRestarted, rate_t::FLAG_FILTER_RESET);
  pass(out.estimate.flags, kStuck, rate_t::FLAG_STUCK);
  pass(out.estimate.flags, kAtRest, rate_t::FLAG_AT_REST);
  return flags;
}

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

// Adds three axes to unsent values.
void add(const Axes& from, bool waits, double* to) noexcept {
  for (std::size_t i = 0; i < kMaxAxes; ++i) to[i] = waits ? to[i] + from[i] : from[i];
}

void mean(const double* sum, const double* over_s, double* to) noexcept {
  for (std::size_t i = 0; i < kMaxAxes; ++i)
    to[i] = over_s[i] > 0.0 ? sum[i] / over_s[i] : std::numeric_limits<double>::quiet_NaN();
}

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
  bool waits_ = false;  // message_ has unsent increments
};

// Rates and specific force of a complete sample, for messages without flags.
struct WholeSample {
  Axes rate_radps{}, specific_force_mps2{};  // means over the sample
};

// False: one of them is unknown. Specific force that arrives less often than rates is that of the last frame
// with it.
bool whole_sample(const Increment& in, const ChainOutput& out, const SensorFacts& facts,
                  WholeSample& sample) noexcept {
  for (std::size_t i = 0; i < kMaxAxes; ++i) {
    if (!(in.covered_s[i] > 0.0) || facts.acceleration_channel[i] < 0) return false;
    sample.rate_radps[i] = out.delta_theta_rad[i] / in.covered_s[i];
    sample.specific_force_mps2[i] = in.moved_s[i] > 0.0
                                        ? in.delta_v_mps[i] / in.moved_s[i]
                                        : in.channel[static_cast<std::size_t>(facts.acceleration_channel[i])];
    if (!std::isfinite(sample.rate_radps[i]) || !std::isfinite(sample.specific_force_mps2[i])) return false;
  }
  return true;
}

// bot_core.ins_t and microstrain.ins_t. Unknown fields are 0, as with their own publishers.
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

// bot_core.kvh_raw_imu_batch_t, one per sample: a packet is in fifteen datagrams, so it is lost only with all
// of them.
class KvhBatchEncoder final : public InertialEncoder {
 public:
  explicit KvhBatchEncoder(const SensorFacts& facts) : facts_(facts), message_(full()), buffer_(message_) {
    message_.raw_imu.clear();  // keeps its memory
  }

  // Merged samples become as many packets of equal angle, because readers divide by a single period. If there
  // are more than a batch holds, packets get the angle of several, so no angle is lost.
  std::span<const std::uint8_t> encode(const Increment& in, const ChainOutput& out) noexcept override {
    WholeSample sample;
    if (!whole_sample(in, out, facts_, sample)) return {};
    const std::size_t fresh = std::min<std::size_t>(std::max<std::uint32_t>(in.samples, 1), kPackets);
    auto& packets = message_.raw_imu;
    packets.resize(std::min(packets.size() + fresh, kPackets));
    std::move_backward(packets.begin(), packets.end() - static_cast<std::ptrdiff_t>(fresh), packets.end());
    const double covered_s = *std::max_element(in.covered_s.begin(), in.covered_s.end());
    const double step_us = covered_s * 1e6 / static_cast<double>(fresh);
    message_.utime = in.utime_ns / 1000;
    for (std::size_t age = 0; age < fresh; ++age) {
      bot_core::kvh_raw_imu_t& packet = packets[age];
      packet.utime = message_.utime - std::llround(step_us * static_cast<double>(age));
      packet.packet_count = static_cast<std::int64_t>(in.sequence) - static_cast<std::int64_t>(age);
      for (std::size_t i = 0; i < kMaxAxes; ++i) {
        packet.delta_rotation[i] = out.delta_theta_rad[i] / static_cast<double>(fresh);
        packet.linear_acceleration[i] = sample.specific_force_mps2[i];
      }
    }
    message_.num_packets = static_cast<std::int32_t>(packets.size());
    return buffer_.encode(message_);
  }

 private:
  static constexpr std::size_t kPackets = 15;  // as the Atlas robot's driver
  static bot_core::kvh_raw_imu_batch_t full() {
    bot_core::kvh_raw_imu_batch_t out;
    out.num_packets = static_cast<std::int32_t>(kPackets);
    out.raw_imu.resize(kPackets);
    return out;
  }
  SensorFacts facts_;
  bot_core::kvh_raw_imu_batch_t message_;
  Buffer<bot_core::kvh_raw_imu_batch_t> buffer_;
};

}  // namespace

RateEncoder::RateEncoder(int axes) : message_() {
  const auto n = static_cast<std::size_t>(axes);
  message_.axes = static_cast<std::int8_t>(axes);
  for (auto* field : {&message_.raw, &message_.compensated, &message_.denoised, &message_.variance,
                      &message_.delta_theta, &message_.covered, &message_.angle, &message_.innovation,
                      &message_.innovation_variance, &message_.gain})
    field->resize(n);
  message_.model.reserve(kLongestIdentity);
  buffer_.resize(static_cast<std::size_t>(message_.getEncodedSize()) + kLongestIdentity);
}

void RateEncoder::use(const ChainParts& parts) {
  message_.model = parts.model_identity().substr(0, kLongestIdentity);
}

std::span<const std::uint8_t> RateEncoder::encode(const Increment& in, const ChainOutput& out,
                                                  const ChainParts& parts) noexcept {
  message_.utime = in.utime_ns / 1000;
  message_.seq = static_cast<std::int64_t>(in.sequence);
  message_.sensor_time_ns = in.device_time_ns;
  message_.arrival_ns = in.arrival_ns != 0 ? in.arrival_ns + in.wall_shift_ns : 0;
  message_.dt = in.dt_s;
  message_.merged = static_cast<std::int32_t>(in.samples);
  message_.flags = message_flags(in, out);
  message_.status = static_cast<std::int32_t>(in.status);
  const auto copy = [n = message_.raw.size()](const Axes& from, std::vector<double>& to) {
    std::copy_n(from.begin(), n, to.begin());
  };
  copy(in.rate_radps, message_.raw);
  copy(out.compensated_radps, message_.compensated);
  copy(out.estimate.denoised_radps, message_.denoised);
  copy(out.estimate.variance_rad2ps2, message_.variance);
  copy(out.delta_theta_rad, message_.delta_theta);
  copy(in.covered_s, message_.covered);
  copy(out.angle_rad, message_.angle);
  copy(out.estimate.innovation_radps, message_.innovation);
  copy(out.estimate.innovation_variance, message_.innovation_variance);
  copy(out.estimate.gain, message_.gain);
  const EstimatorHealth* const health = parts.health();
  message_.group_delay = health != nullptr ? health->group_delay_s : 0.0;
  message_.correlation_time = health != nullptr ? health->correlation_time_s : 0.0;
  const int size = message_.encode(buffer_.data(), 0, static_cast<int>(buffer_.size()));
  return {buffer_.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
}

std::unique_ptr<InertialEncoder> make_inertial_encoder(std::string_view type, const SensorFacts& facts) {
  if (type == kInertialType) return std::make_unique<IncrementEncoder<inertial_t>>(facts.temperature_channel);
  if (type == kInsType) return std::make_unique<InsEncoder<bot_core::ins_t>>(facts);
  if (type == kMicrostrainType) return std::make_unique<InsEncoder<microstrain::ins_t>>(facts);
  if (type == kKvhBatchType) return std::make_unique<KvhBatchEncoder>(facts);
  return std::make_unique<IncrementEncoder<imu_t>>(facts.temperature_channel);
}

}  // namespace ifog
