// SPDX-License-Identifier: Apache-2.0
#include "daemon/publish/kvh_batch_encoder.h"

#include <algorithm>
#include <cmath>

#include "daemon/publish/whole_sample.h"

namespace ifog {

KvhBatchEncoder::KvhBatchEncoder(const SensorFacts& facts) : facts_(facts), message_() {
  message_.raw_imu.resize(kPackets);
  message_.num_packets = static_cast<std::int32_t>(kPackets);
  buffer_.resize(static_cast<std::size_t>(message_.getEncodedSize()));
  message_.raw_imu.clear();  // keeps its memory
}

// Samples that were merged become as many packets again, of the same angle each: a reader divides by the
// period of one. More than a batch holds share its packets, so that no angle is lost.
std::span<const std::uint8_t> KvhBatchEncoder::encode(const Increment& in, const ChainOutput& out) noexcept {
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
  const int size = message_.encode(buffer_.data(), 0, static_cast<int>(buffer_.size()));
  return {buffer_.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
}

}  // namespace ifog
