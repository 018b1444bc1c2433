// SPDX-License-Identifier: Apache-2.0
// Normal Mode datagram of the Sensonor STIM300, in counts. Big-endian. Source: STIM300 datasheet TS1524 rev.
// 31, tables 5-20 to 5-23, section 5.5.7; identifiers with AUX, replaced by PPS, from revisions up to 19.
//
//   identifier, then what it announces, in this order:
//   gyro, accelerometer, inclinometer: three int24 and a status byte each
//   temperatures of each of these that is present: three int16 and a status byte each
//   PPS or AUX: an int24 and a status byte
//   then counter (uint8), latency in µs (uint16), CRC (uint32), and CR LF if configured
//
// The CRC is CRC-32/MPEG-2 over all bytes before it, zero-padded to full words (the padding is not sent).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/plugins/framing/frame_finder.h"

namespace ifog::stim300 {

struct Content {
  std::uint8_t identifier;
  bool acceleration, inclination, temperature, pps, aux;

  bool operator==(const Content&) const = default;
};

// Table 5-21, then those with AUX.
inline constexpr std::array<Content, 24> kContents{
    {{0x90, false, false, false, false, false}, {0x91, true, false, false, false, false},
     {0x92, false, true, false, false, false},  {0x93, true, true, false, false, false},
     {0x94, false, false, true, false, false},  {0xA5, true, false, true, false, false},
     {0xA6, false, true, true, false, false},   {0xA7, true, true, true, false, false},
     {0xF0, false, false, false, true, false},  {0xF1, true, false, false, true, false},
     {0xF2, false, true, false, true, false},   {0xF3, true, true, false, true, false},
     {0xF4, false, false, true, true, false},   {0xF5, true, false, true, true, false},
     {0xF6, false, true, true, true, false},    {0xF7, true, true, true, true, false},
     {0x98, false, false, false, false, true},  {0x99, true, false, false, false, true},
     {0x9A, false, true, false, false, true},   {0x9B, true, true, false, false, true},
     {0x9C, false, false, true, false, true},   {0xAD, true, false, true, false, true},
     {0xAE, false, true, true, false, true},    {0xAF, true, true, true, false, true}}};

inline constexpr std::size_t kCrcLength = 4, kTermination = 2;

// Length of the datagram, without termination.
constexpr std::size_t length_of(const Content& content) noexcept {
  const std::size_t triads = 1U + (content.acceleration ? 1U : 0U) + (content.inclination ? 1U : 0U);
  return 1 + triads * (10 + (content.temperature ? 7U : 0U)) + (content.pps || content.aux ? 4U : 0U) + 3 +
         kCrcLength;
}
inline constexpr std::size_t kLongestDatagram = [] {
  std::size_t longest = 0;
  for (const Content& content : kContents) longest = std::max(longest, length_of(content));
  return longest;
}();

// Status byte, table 5-23.
inline constexpr std::uint8_t kIntegrityError = 0x80, kStartUp = 0x40, kOverload = 0x10, kChannelError = 0x08;

struct Triad {
  std::array<std::int32_t, 3> count{};
  std::uint8_t status = 0;

  bool operator==(const Triad&) const = default;
};

struct Datagram {
  Content content{};
  Triad gyro, acceleration, inclination;
  Triad gyro_temperature, acceleration_temperature, inclination_temperature;
  std::int32_t extra = 0;  // PPS or AUX
  std::uint8_t extra_status = 0;
  std::uint8_t counter = 0;  // of the 2000 internal samples per second
  std::uint16_t latency_us = 0;
};

// Content announced by the identifier; nullopt if it is invalid.
std::optional<Content> content_of(std::uint8_t identifier) noexcept;

Datagram unpack(const Content& content, std::span<const std::uint8_t> bytes) noexcept;
// Includes the CRC; returns the length.
std::size_t pack(const Datagram& datagram, std::span<std::uint8_t, kLongestDatagram> out);

// For the finder of intact frames.
struct Protocol {
  static constexpr std::size_t kLongest = kLongestDatagram + kTermination;
  bool terminated = false;  // by CR LF

  [[nodiscard]] framing::Announced at(std::span<const std::uint8_t> bytes) const noexcept;
  [[nodiscard]] bool intact(std::span<const std::uint8_t> frame) const noexcept;
};

}  // namespace ifog::stim300
