// A Normal Mode datagram of the Sensonor STIM300, in counts. Everything is big-endian.
// Source: STIM300 datasheet TS1524 rev. 31, tables 5-20 to 5-23, section 5.5.7; the identifiers with AUX,
// which PPS has replaced, from its revisions up to 19.
//
//   identifier, then of what it announces in this order:
//   gyro, accelerometer, inclinometer: three int24 and a status byte each
//   temperatures of each of these that is there: three int16 and a status byte each
//   PPS or AUX: an int24 and a status byte
//   then counter (uint8), latency in µs (uint16), CRC (uint32), and CR LF where the device is set so
//
// The CRC is CRC-32/MPEG-2 over all bytes before it and as many zeros, never sent, as make them full words.
#pragma once

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

inline constexpr std::size_t kLongestDatagram = 62, kTermination = 2;

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
  std::uint8_t counter = 0;  // of the internal samples, 2000 a second
  std::uint16_t latency_us = 0;
};

// What the identifier announces; nothing if it is none.
std::optional<Content> content_of(std::uint8_t identifier) noexcept;
// Of the datagram, without termination.
std::size_t length_of(const Content& content) noexcept;

Datagram unpack(const Content& content, std::span<const std::uint8_t> bytes) noexcept;
// CRC included; returns its length.
std::size_t pack(const Datagram& datagram, std::span<std::uint8_t, kLongestDatagram> out) noexcept;
bool crc_fits(std::span<const std::uint8_t> datagram) noexcept;

// For the finder of intact frames.
struct Protocol {
  static constexpr std::size_t kLongest = kLongestDatagram + kTermination;
  bool terminated = false;  // by CR LF

  [[nodiscard]] framing::Announced at(std::span<const std::uint8_t> bytes) const noexcept;
  [[nodiscard]] bool intact(std::span<const std::uint8_t> frame) const noexcept;
};

}  // namespace ifog::stim300
