// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/lcm/peer_reader.h"

#include <ifog/decode.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "tools/ifog/captures/lcm/lcm_events.h"

namespace ifog::tools {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr double kStandardGravity = 9.80665;  // m/s² per g
// Some publishers leave the device's clock uninitialised; larger values are unknown.
constexpr std::int64_t kMostTime_us = 4'000'000'000'000'000;
constexpr std::int64_t kKvhModulus = 128;  // KVH 1750 technical manual: the sequence number is 0 to 127

template <typename Number>
PeerSample three_axes(std::int64_t utime, const Number* rates, const Number* forces) {
  PeerSample sample;
  sample.utime = utime;
  std::copy_n(rates, 3, sample.value.begin());
  std::copy_n(forces, 3, sample.specific_force_mps2.begin());
  return sample;
}

template <typename Message>
bool ins(Bytes bytes, std::vector<PeerSample>& out) {
  Message message;
  if (!decode_message(bytes, message)) return false;
  PeerSample sample = three_axes(message.utime, message.gyro, message.accel);
  if constexpr (std::is_same_v<Message, microstrain::ins_t>) {
    if (std::abs(message.device_time) < 1e-6 * static_cast<double>(kMostTime_us))
      sample.device_ns = std::llround(message.device_time * 1e9);
  } else if (const std::int64_t device_us = message.device_time;
             device_us < kMostTime_us && device_us > -kMostTime_us) {
    sample.device_ns = device_us * 1000;
  }
  out.push_back(sample);
  return true;
}

bool kvh_batch(Bytes bytes, std::vector<PeerSample>& out) {
  bot_core::kvh_raw_imu_batch_t message;
  if (!decode_message(bytes, message)) return false;
  for (auto packet = message.raw_imu.rbegin(); packet != message.raw_imu.rend(); ++packet) {
    PeerSample sample = three_axes(packet->utime, packet->delta_rotation, packet->linear_acceleration);
    sample.kind = PeerSample::Kind::delta;
    sample.count = packet->packet_count;
    out.push_back(sample);
  }
  return true;
}

bool kvh1750(Bytes bytes, std::vector<PeerSample>& out) {
  senlcm::kvh1750_t message;
  if (!decode_message(bytes, message) || message.sequence < 0) return false;
  PeerSample sample;
  sample.utime = message.utime;
  sample.count = static_cast<std::uint8_t>(message.sequence);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto status = static_cast<unsigned>(static_cast<std::uint8_t>(message.status));
    if ((status >> i & 1U) != 0) sample.value[i] = message.angular[i];
    if ((status >> (i + 4) & 1U) != 0) sample.specific_force_mps2[i] = message.linear[i] * kStandardGravity;
  }
  sample.temperature_degC = message.temperature;
  out.push_back(sample);
  return true;
}

bool dsp3000(Bytes bytes, std::vector<PeerSample>& out) {
  using Message = senlcm::kvh_dsp3000_t;
  Message message;
  if (!decode_message(bytes, message) || message.mode < Message::RATE_MODE ||
      message.mode > Message::ANGLE_MODE)
    return false;
  PeerSample sample;
  sample.kind = message.mode == Message::RATE_MODE    ? PeerSample::Kind::rate
                : message.mode == Message::DELTA_MODE ? PeerSample::Kind::delta
                                                      : PeerSample::Kind::angle;
  sample.utime = message.utime;
  sample.value[0] = message.data;
  out.push_back(sample);
  return true;
}

bool senlcm_imu(Bytes bytes, std::vector<PeerSample>& out) {
  senlcm::IMU_t message;
  if (!decode_message(bytes, message)) return false;
  PeerSample sample = three_axes(message.utime, message.angRate, message.accel);
  out.push_back(sample);
  return true;
}

template <typename Message>
bool increments(Bytes bytes, std::vector<PeerSample>& out) {
  Message message;
  if (!decode_message(bytes, message)) return false;
  PeerSample sample;
  sample.utime = message.utime;
  sample.count = message.seq;
  sample.device_ns = message.sensor_time_ns;
  sample.flags = message.flags;
  sample.merged = message.merged;
  for (std::size_t i = 0; i < 3; ++i) {
    if (message.turned_s[i] > 0.0) sample.value[i] = message.delta_theta[i] / message.turned_s[i];
    if (message.moved_s[i] > 0.0) sample.specific_force_mps2[i] = message.delta_v[i] / message.moved_s[i];
  }
  sample.temperature_degC = message.temperature_degC;
  out.push_back(sample);
  return true;
}

}  // namespace

const PeerType* peer_type(Bytes message) {
  using Count = PeerType::Count;
  static const std::array<PeerType, 8> types{{
      {"bot_core.ins_t", bot_core::ins_t::getHash(), 3, true, false, Count::none, 0, ins<bot_core::ins_t>},
      {"microstrain.ins_t", microstrain::ins_t::getHash(), 3, true, false, Count::none, 0,
       ins<microstrain::ins_t>},
      {"bot_core.kvh_raw_imu_batch_t", bot_core::kvh_raw_imu_batch_t::getHash(), 3, true, false,
       Count::repeats, 0, kvh_batch},
      {"senlcm.kvh1750_t", senlcm::kvh1750_t::getHash(), 3, true, true, Count::whole, kKvhModulus, kvh1750},
      {"senlcm.kvh_dsp3000_t", senlcm::kvh_dsp3000_t::getHash(), 1, false, false, Count::none, 0, dsp3000},
      {"senlcm.IMU_t", senlcm::IMU_t::getHash(), 3, true, false, Count::none, 0, senlcm_imu},
      {"ifog.inertial_t", inertial_t::getHash(), 3, true, true, Count::whole, 0, increments<inertial_t>},
      {"ifog.imu_t", imu_t::getHash(), 3, true, true, Count::whole, 0, increments<imu_t>},
  }};
  const std::int64_t hash = type_hash(message);
  const auto* const found =
      std::find_if(types.begin(), types.end(), [hash](const PeerType& type) { return type.hash == hash; });
  return found != types.end() ? &*found : nullptr;
}

}  // namespace ifog::tools
