// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/captures/lcm/peer_reader.h"

#include <ifog/decode.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "drivers/row_times/median.h"
#include "tools/ifog/captures/lcm/lcm_events.h"

namespace ifog::tools {
namespace {

constexpr std::size_t kMostSteps = 1'000'000;  // sufficient for a mean accurate to 1e-6
// A count that falls by this much is a restart of the sensor, not a delayed packet of a batch.
constexpr std::int64_t kRestart = 64;
// Limit of received numbers, so that differences do not overflow, also in ns.
constexpr std::int64_t kMostNumber = std::numeric_limits<std::int64_t>::max() / 2;

bool can_be(std::int64_t number, std::int64_t most) { return number < most && number > -most; }

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

std::vector<std::string> PeerReader::extra_columns() const {
  std::vector<std::string> out;
  if (type_->specific_force) out = {"accel_x_mps2", "accel_y_mps2", "accel_z_mps2"};
  if (type_->temperature) out.emplace_back("temperature_degC");
  return out;
}

// Adds whole rollovers that were lost, by the elapsed time.
std::int64_t PeerReader::unwrapped(const PeerSample& sample) const {
  if (type_->count == PeerType::Count::none) return last_ ? last_->count + 1 : 0;
  if (type_->modulus == 0 || !last_) return sample.count;
  const std::int64_t modulus = type_->modulus, late = 16;  // messages; a network may reorder that many
  std::int64_t ahead = ((sample.count - last_->count) % modulus + modulus) % modulus;
  if (ahead > modulus - late) return last_->count + ahead - modulus;
  if (period_s_ && *period_s_ > 0.0) {
    const double periods = static_cast<double>(sample.utime - last_->utime) * 1e-6 / *period_s_;
    const double rollovers =
        std::round((periods - static_cast<double>(ahead)) / static_cast<double>(modulus));
    if (rollovers > 0.0 && rollovers < 1e9) ahead += static_cast<std::int64_t>(rollovers) * modulus;
  }
  return last_->count + ahead;
}

bool PeerReader::again(const PeerSample& sample) {
  if (type_->count != PeerType::Count::repeats || !last_) return false;
  return sample.count <= last_->count && sample.count > last_->count - kRestart;
}

bool PeerReader::unpack(std::span<const std::uint8_t> message) {
  samples_.clear();
  if (!type_->unpack(message, samples_)) return false;
  return std::ranges::all_of(samples_, [](const PeerSample& sample) {
    return can_be(sample.utime, kMostNumber / 1000) && can_be(sample.count, kMostNumber) &&
           can_be(sample.device_ns, kMostNumber);
  });
}

void PeerReader::look_at(std::span<const std::uint8_t> message) {
  if (!unpack(message)) return;
  for (const PeerSample& sample : samples_) {
    if (again(sample)) continue;
    const std::int64_t count = unwrapped(sample);
    if (last_ && count > last_->count) {
      const double step_us = static_cast<double>(sample.utime) - static_cast<double>(last_->utime);
      if (step_us > 0.0 && steps_us_.size() < kMostSteps)
        steps_us_.push_back(step_us / static_cast<double>(count - last_->count));
      advance_us_ += step_us;
      device_advance_us_ +=
          (static_cast<double>(sample.device_ns) - static_cast<double>(last_->device_ns)) * 1e-3;
    }
    last_ = {count, sample.utime, sample.device_ns};
  }
}

// Elapsed time divided by the number of periods, from the median step; lost messages and jitter of the stamps
// do not bias it.
double PeerReader::period_s() {
  if (period_s_) return *period_s_;
  period_s_ = 0.0;
  if (steps_us_.empty()) return 0.0;
  const double median_us = median(steps_us_);
  double sum_us = 0.0, periods = 0.0;
  for (const double step_us : steps_us_) {
    sum_us += step_us;
    periods += std::round(step_us / median_us);
  }
  steps_us_ = {};
  period_s_ = sum_us / periods * 1e-6;
  return *period_s_;
}

bool PeerReader::take(std::span<const std::uint8_t> message,
                      const std::function<void(MeasuredRate&&)>& sink) {
  if (!std::exchange(second_look_, true)) {
    (void)period_s();
    last_.reset();
  }
  if (!unpack(message)) return false;
  constexpr double kSameClock = 0.01;  // relative rate error of a sensor's clock
  const bool clock = std::abs(device_advance_us_ - advance_us_) < kSameClock * advance_us_;
  for (const PeerSample& sample : samples_) {
    if (again(sample)) continue;
    const std::int64_t count = unwrapped(sample);
    double over_s = period_s();  // an accumulated angle: as many periods as have passed
    if (sample.kind == PeerSample::Kind::angle && last_ && over_s > 0.0)
      over_s *= std::max(1.0, std::round(static_cast<double>(sample.utime - last_->utime) * 1e-6 / over_s));
    last_ = {count, sample.utime, sample.device_ns};
    MeasuredRate out;
    static_cast<rate_t&>(out) = rate_t();
    out.utime = sample.utime;
    out.seq = count;
    out.sensor_time_ns = clock ? sample.device_ns : -1;
    out.dt = 0.0;
    out.flags = sample.flags;
    out.merged = sample.merged;
    out.axes = static_cast<std::int8_t>(type_->axes);
    out.raw.assign(sample.value.begin(), sample.value.begin() + static_cast<std::ptrdiff_t>(type_->axes));
    if (sample.kind == PeerSample::Kind::angle) out.raw[0] -= std::exchange(angle_, sample.value[0]);
    if (sample.kind != PeerSample::Kind::rate)
      for (double& value : out.raw) value = over_s > 0.0 ? value / over_s : PeerSample::kUnknown;
    if (type_->specific_force)
      out.extra.assign(sample.specific_force_mps2.begin(), sample.specific_force_mps2.end());
    if (type_->temperature) out.extra.push_back(sample.temperature_degC);
    sink(std::move(out));
  }
  return true;
}

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
      std::ranges::find_if(types, [hash](const PeerType& type) { return type.hash == hash; });
  return found != types.end() ? &*found : nullptr;
}

}  // namespace ifog::tools
