// SPDX-License-Identifier: Apache-2.0
// Entries of a flight recording; format.md describes every byte. The same bytes are passed from the reader
// thread to the recorder thread and into the file.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

namespace ifog {

static_assert(std::endian::native == std::endian::little, "the format is little-endian, and copied as it is");

enum class FlightKind : std::uint8_t {
  bytes = 1,    // one read of a byte transport; time: of its last byte
  can = 2,      // one frame: u32 id, u8 flags (ifog_can_flags), u8 length, data
  channel = 3,  // f64: value of environment channel `index`; time: of the measurement
  wall = 4,     // i64: change of the wall clock since the arrival clock started, ns
  lost = 5,     // u64 deliveries, u64 bytes: received before this, but not in the recording
  message = 6,  // of LCM: `index` bytes of the channel's name, then the message; time: of its arrival
  // u64: samples of this run merged with others before the filter since the last such entry, because the ring
  // after the driver was full.
  merged = 7,
  // Only on the way to the recorder, never in a file. Later entries were filtered with settings number
  // `length`; they go into a new file whose header has these settings.
  settings = 255,
};

enum FlightFlag : std::uint8_t {
  kFlightReadTime = 1,  // the time is that of the read; the arrival time is unknown
  kFlightReopened = 2,  // the first since the device was reopened
  kFlightStamped = 4,   // the time is the kernel's
};

// Head of each entry. Times are of the arrival clock (drivers/transport/clock.h), of LCM messages of the wall
// clock; ns since the epoch.
struct FlightEntryHead {
  FlightKind kind = FlightKind::bytes;
  std::uint8_t flags = 0;
  std::uint16_t index = 0;
  std::uint32_t length = 0;  // of the payload, bytes
  std::int64_t time_ns = 0;

  // From a device or LCM, not a state.
  [[nodiscard]] bool is_received() const noexcept {
    return kind == FlightKind::bytes || kind == FlightKind::can || kind == FlightKind::message;
  }
};
static_assert(sizeof(FlightEntryHead) == 16);

inline constexpr std::size_t kMostFlightPayload = 1U << 20U;  // per entry

struct FlightEntry {
  FlightEntryHead head;
  std::span<const std::uint8_t> payload;

  // Reads a number at offset `at` of the payload; false if the payload is too short.
  template <typename T>
  bool value(T& out, std::size_t at = 0) const noexcept {
    if (payload.size() < at + sizeof out) return false;
    std::memcpy(&out, payload.data() + at, sizeof out);
    return true;
  }
};

// Removes the first entry from `content`. False: no complete or valid entry.
inline bool take_entry(std::span<const std::uint8_t>& content, FlightEntry& out) noexcept {
  if (content.size() < sizeof out.head) return false;
  std::memcpy(&out.head, content.data(), sizeof out.head);
  if (out.head.length > kMostFlightPayload || content.size() - sizeof out.head < out.head.length)
    return false;
  out.payload = content.subspan(sizeof out.head, out.head.length);
  content = content.subspan(sizeof out.head + out.head.length);
  return true;
}

inline void append_entry(std::vector<std::uint8_t>& to, FlightEntryHead head,
                         std::span<const std::uint8_t> payload) {
  head.length = static_cast<std::uint32_t>(payload.size());
  const std::size_t at = to.size();
  to.resize(at + sizeof head + payload.size());
  std::memcpy(to.data() + at, &head, sizeof head);
  if (!payload.empty()) std::memcpy(to.data() + at + sizeof head, payload.data(), payload.size());
}

// Latest value and time of an environment channel that is not in the sensor's frames.
struct ChannelValue {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::int64_t time_ns = 0;  // of the measurement, arrival clock; 0: none yet

  // Age at the arrival `now_ns` of a sample; infinite before the first value, never negative.
  [[nodiscard]] float age_s(std::int64_t now_ns) const noexcept {
    if (time_ns == 0) return std::numeric_limits<float>::infinity();
    return std::max(0.0F, static_cast<float>(now_ns - time_ns) * 1e-9F);
  }
  // Compares bits, so that NaN equals itself.
  [[nodiscard]] bool same(const ChannelValue& other) const noexcept {
    return time_ns == other.time_ns &&
           std::bit_cast<std::uint64_t>(value) == std::bit_cast<std::uint64_t>(other.value);
  }
};

}  // namespace ifog
