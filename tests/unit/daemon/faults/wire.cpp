// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/daemon/faults/wire.h"

#include <algorithm>
#include <array>
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

Wire::Fates Wire::draw_fates() {
  Fates out;
  const int first = below(100);
  if (first >= kFates) return out;
  out.set(static_cast<std::size_t>(first));
  if (below(2) == 0) out.set(static_cast<std::size_t>(below(kFates)));
  return out;
}

void Wire::add_bytes(std::uint32_t number) {
  ifog_sample sample{};
  sample.flags = IFOG_SAMPLE_SEQUENCE;
  sample.sequence = number % kKvhModulus;
  sample.valid_axes = 7;
  for (double& value : sample.value) value = rate();
  const Fates fates = draw_fates();
  if (fates[kImpossible]) sample.value[0] = below(2) != 0 ? 1e30 : -8.6;  // beyond full scale
  if (fates[kInvalid]) sample.valid_axes = 6;
  std::vector<std::uint8_t> made;
  driver_.encode_bytes(sample, made);
  const int copies = fates[kTwice] ? 2 : 1;
  for (int copy = 0; copy < copies; ++copy) {
    const bool first = copy == 0;
    if (fates[kNoise] && copy + 1 == copies)
      for (int n = below(200); n >= 0; --n) bytes.push_back(static_cast<std::uint8_t>(below(256)));
    if (fates[kLost] && first) continue;
    std::vector<std::uint8_t> sent = made;
    if (fates[kDamaged] && first)  // a checksum of 32 bits finds every single bit
      sent[static_cast<std::size_t>(below(kFrame))] ^= static_cast<std::uint8_t>(1U << below(8));
    // Cut off by the whole checksum at least: the next frame may begin with the one byte that is missing.
    if (fates[kShort] && first) sent.resize(static_cast<std::size_t>(below(kFrame - 4) + 1));
    if (!first || (!fates[kDamaged] && !fates[kShort]))
      intact_.push_back({bytes.size(), bytes.size() + kFrame, sample.sequence,
                         !fates[kImpossible] && !fates[kInvalid],
                         static_cast<double>(static_cast<float>(sample.value[0]))});
    bytes.insert(bytes.end(), sent.begin(), sent.end());
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
  const Fates fates = draw_fates();
  constexpr std::array kNoRate{1e30F, -2e4F, std::numeric_limits<float>::quiet_NaN()};
  const bool valid = !fates[kImpossible] && !fates[kInvalid];
  if (!valid) value = kNoRate.at(static_cast<std::size_t>(below(3)));
  put(frame, 0, value);
  frame.data[4] = static_cast<std::uint8_t>(sequence & 0xFFU);
  frame.data[5] = static_cast<std::uint8_t>(sequence >> 8U);
  const int copies = fates[kTwice] ? 2 : 1;
  for (int copy = 0; copy < copies; ++copy) {
    const bool first = copy == 0;
    if (fates[kNoise] && copy + 1 == copies)
      for (int n = below(100); n >= 0; --n) add_other_frame(arrival_ns);
    if (fates[kDamaged] && copy + 1 == copies) {  // the device's temperature, at times one that cannot be
      ifog_can_frame environment = can_frame(kEnvironmentId, arrival_ns);
      put(environment, 0, below(4) == 0 ? 1e6F : static_cast<float>(20 + below(10)));
      frames.push_back(environment);
      fate_.push_back(Fate::good);
    }
    if (fates[kLost] && first) continue;
    if (fates[kShort] && first) {  // for its counter
      ifog_can_frame part = frame;
      part.length = static_cast<std::uint8_t>(below(6));
      frames.push_back(part);
      fate_.push_back(Fate::refused);
      continue;
    }
    const Held held{frame, {0, 0, sequence, valid, static_cast<double>(value)}};
    if (fates[kOvertaken])
      held_.push_back(held);
    else
      add_frame(held, arrival_ns);
  }
  if (fates[kOvertaken]) return;
  for (const Held& late : held_) add_frame(late, arrival_ns);
  held_.clear();
}

void Wire::add_frame(const Held& held, std::int64_t arrival_ns) {
  Sent sent = held.sent;
  sent.begin = frames.size();
  sent.end = sent.begin + 1;
  intact_.push_back(sent);
  frames.push_back(held.frame);
  frames.back().arrival_ns = arrival_ns;
  fate_.push_back(Fate::good);
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
    // A counter of a bus does not go round in a run, and one that was overtaken comes too late.
    if (can_ ? sent.sequence <= last : sent.sequence == last) {
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
