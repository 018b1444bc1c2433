// SPDX-License-Identifier: Apache-2.0
// Message of a KVH 1725/1750/1775 IMU or DSP-1760, in the units sent. Big-endian. Source: 1775 IMU technical
// manual 56-0298, tables 5-1 to 5-9.
//
//   A, 36 bytes: FE 81 FF 55, 3 gyro floats, 3 accelerometer floats, status, sequence, int16 temperature, CRC
//   B, 40 bytes: FE 81 FF 56, the same with a uint32 time stamp in µs after the accelerometers
//   C, 38 bytes: FE 81 FF 57, as A without the int16, but with a float after the accelerometers: temperature
//   or magnetic field along x, y, z in gauss, by the sequence modulo four
//
// The CRC is CRC-32/MPEG-2 over all bytes before it, including the header.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/plugins/framing/frame_finder.h"

namespace ifog::kvh {

enum class Format : std::uint8_t { kA = 0x55, kB = 0x56, kC = 0x57 };  // last byte of the header

inline constexpr std::size_t kHeaderLength = 4;
inline constexpr std::size_t kLongestFrame = 40;
inline constexpr std::uint32_t kSequenceModulus = 128;

// Status byte: 1 is valid. Bits 3 and 7 are reserved.
inline constexpr std::uint8_t kGyroValid = 0x01;           // x; y and z are the next two bits
inline constexpr std::uint8_t kAccelerometerValid = 0x10;  // x; y and z are the next two bits

struct Frame {
  Format format = Format::kA;
  std::array<float, 3> gyro{};           // rate or delta angle, rad or deg, by the device's settings
  std::array<float, 3> accelerometer{};  // specific force in g, or delta velocity in m/s
  std::uint32_t time_stamp_us = 0;       // B only
  std::uint8_t status = 0;
  std::uint8_t sequence = 0;     // 0 … 127
  std::int16_t temperature = 0;  // A and B only; the scale is a setting of the device
  float slow = 0.0F;             // C only: see slow_quantity
};

// Content of `slow` in format C: 0 temperature; 1, 2, 3 magnetic field along x, y, z.
constexpr std::size_t slow_quantity(std::uint8_t sequence) { return sequence % 4U; }

constexpr std::size_t length_of(Format format) {
  return format == Format::kA ? 36 : format == Format::kB ? 40 : 38;
}

// Reads an intact frame.
Frame unpack(std::span<const std::uint8_t> frame) noexcept;

// Writes the frame with its CRC; returns its length.
std::size_t pack(const Frame& frame, std::span<std::uint8_t, kLongestFrame> out);

// For the finder of intact frames.
struct Protocol {
  static constexpr std::size_t kLongest = kLongestFrame;
  static constexpr std::uint8_t kFirst = 0xFE;

  [[nodiscard]] static framing::Announced at(std::span<const std::uint8_t> bytes) noexcept;
  [[nodiscard]] static bool intact(std::span<const std::uint8_t> frame) noexcept;
};

}  // namespace ifog::kvh
