// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/daemon/faults/wire.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace ifog {
namespace {

constexpr std::size_t kFrame = 36;                            // bytes, KVH 1750 format A
constexpr std::uint32_t kRateId = 256, kEnvironmentId = 272;  // of the example DBC file
constexpr std::uint32_t kKvhModulus = 128, kCanModulus = 1U << 16U;

ifog_can_frame can_frame(std::uint32_t id, std::int64_t arrival_ns) {
  ifog_can_frame out{};
  out.id = id;
  out.length = 8;
  out.arrival_ns = arrival_ns;
  return out;
}

void put(ifog_can_frame& frame, std::size_t at, float value) {
  std::memcpy(frame.data + at, &value, sizeof value);
}

}  // namespace

DriverInstance Wire::driver(bool can) {
  if (!can) return make_driver("kvh1750", {{"format", "a"}});
  return make_driver("dbc", {{"dbc", IFOG_SOURCE_DIR "/drivers/dbc/examples/ifogd_gyro.dbc"},
                             {"signal", "Rate_x"},
                             {"counter", "Rate_X.Counter"},
                             {"environment", "temperature_degC=Temperature"},
                             {"rate_hz", "1000"}});
}

Wire::Wire(std::mt19937& random, bool can, int samples) : random_(random), can_(can), driver_(driver(can)) {
  for (int n = 0; n < samples; ++n)
    if (can)
      add_frames(static_cast<std::uint32_t>(n));
    else
      add_bytes(static_cast<std::uint32_t>(n));
}

void Wire::add_bytes(std::uint32_t number) {
  ifog_sample sample{};
  sample.flags = IFOG_SAMPLE_SEQUENCE;
  sample.sequence = number % kKvhModulus;
  sample.valid_axes = 7;
  for (double& value : sample.value) value = rate();
  const int fate = below(100);
  if (fate == 0) sample.value[0] = below(2) != 0 ? 1e30 : -8.6;  // beyond full scale
  if (fate == 1) sample.valid_axes = 6;
  std::vector<std::uint8_t> made;
  driver_.encode_bytes(sample, made);
  if (fate == 2) return;  // lost on the way
  if (fate == 3)          // damaged: a checksum of 32 bits finds every single bit
    made[static_cast<std::size_t>(below(kFrame))] ^= static_cast<std::uint8_t>(1U << below(8));
  // Cut off by the whole checksum at least: the next frame may begin with the one byte that is missing.
  if (fate == 4) made.resize(static_cast<std::size_t>(below(kFrame - 4) + 1));
  if (fate == 5)
    for (int n = below(200); n >= 0; --n) bytes.push_back(static_cast<std::uint8_t>(below(256)));
  for (int copies = fate == 6 ? 2 : 1; copies > 0; --copies) {
    if (fate != 3 && fate != 4)
      intact_.push_back({bytes.size(), bytes.size() + kFrame, sample.sequence, fate > 1,
                         static_cast<double>(static_cast<float>(sample.value[0]))});
    bytes.insert(bytes.end(), made.begin(), made.end());
  }
}

void Wire::add_other_frame(std::int64_t arrival_ns) {
  ifog_can_frame frame = can_frame(static_cast<std::uint32_t>(300 + below(1000)), arrival_ns);
  if (below(3) == 0) {  // the sensor's own id, but of 29 bits
    frame.id = kRateId;
    frame.flags = IFOG_CAN_EXTENDED;
  }
  frames.push_back(frame);
  fate_.push_back(Fate::other);
}

void Wire::add_frames(std::uint32_t number) {
  const std::int64_t arrival_ns = kBegin_ns + static_cast<std::int64_t>(number) * 1'000'000;
  const std::uint32_t sequence = number % kCanModulus;
  ifog_can_frame frame = can_frame(kRateId, arrival_ns);
  auto value = static_cast<float>(rate());
  const int fate = below(100);
  constexpr std::array kImpossible{1e30F, -20.5F, std::numeric_limits<float>::quiet_NaN()};
  if (fate <= 1) value = kImpossible.at(static_cast<std::size_t>(below(3)));
  put(frame, 0, value);
  frame.data[4] = static_cast<std::uint8_t>(sequence & 0xFFU);
  frame.data[5] = static_cast<std::uint8_t>(sequence >> 8U);
  if (fate == 2) return;  // lost on the way
  if (fate == 3) {        // too short for its counter
    frame.length = static_cast<std::uint8_t>(below(6));
    frames.push_back(frame);
    fate_.push_back(Fate::refused);
    return;
  }
  if (fate == 4)
    for (int n = below(100); n >= 0; --n) add_other_frame(arrival_ns);
  if (fate == 5) {  // the device's temperature, at times one that cannot be
    ifog_can_frame environment = can_frame(kEnvironmentId, arrival_ns);
    put(environment, 0, below(4) == 0 ? 1e6F : static_cast<float>(20 + below(10)));
    frames.push_back(environment);
    fate_.push_back(Fate::good);
  }
  for (int copies = fate == 6 ? 2 : 1; copies > 0; --copies) {
    intact_.push_back({frames.size(), frames.size() + 1, sequence, fate > 1, static_cast<double>(value)});
    frames.push_back(frame);
    fate_.push_back(Fate::good);
  }
}

std::int64_t Wire::arrival_ns(std::size_t n) const {
  if (can_) return n == 0 ? kBegin_ns : frames[n - 1].arrival_ns;
  return kBegin_ns + static_cast<std::int64_t>(n * 1'000'000 / kFrame);
}

Truth Wire::truth(const std::vector<std::size_t>& cuts, std::size_t given) const {
  Truth out;
  std::int64_t last = -1;
  for (const Sent& sent : intact_) {
    const bool severed = std::any_of(cuts.begin(), cuts.end(),
                                     [&](std::size_t cut) { return sent.begin < cut && cut < sent.end; });
    if (sent.end > given || severed) continue;
    ++out.decoded;
    if (sent.sequence == last) {
      ++out.repeated;
      continue;
    }
    last = sent.sequence;
    out.invalid += sent.valid ? 0 : 1;
    if (sent.valid) out.angle += sent.rate * kPeriod_s;
  }
  for (std::size_t i = 0; can_ && i < given; ++i) {
    out.frames_good += fate_[i] == Fate::good ? 1 : 0;
    out.frames_refused += fate_[i] == Fate::refused ? 1 : 0;
    out.frames_other += fate_[i] == Fate::other ? 1 : 0;
  }
  return out;
}

}  // namespace ifog
