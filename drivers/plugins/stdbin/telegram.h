// SPDX-License-Identifier: Apache-2.0
// Navigation telegrams of the iXblue (Exail) STDBIN protocol, versions 2 to 5. Big-endian. Source: iXblue,
// INS interface library, STD BIN protocol: header, block masks and block lengths.
//
//   'I' 'X', version, uint32 mask of navigation blocks, from version 3 on uint32 mask of extended navigation
//   blocks, uint32 mask of external sensor blocks, from version 4 on uint16 length of the navigation blocks,
//   uint16 length of the telegram, uint32 time of validity in 100 µs, uint32 counter; then the blocks, in the
//   order of the masks' bits; then the uint32 sum of all bytes before.
//
// The sum is a weak check, so the masks and the lengths must agree as well.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/plugins/framing/frame_finder.h"

namespace ifog::stdbin {

using Triad = std::array<float, 3>;

// Decoded part of a telegram. Vessel frame: x forward, y to port, z up; rotations right-handed.
struct Telegram {
  std::uint8_t version = 3;
  std::uint32_t validity_100us = 0;
  std::uint32_t counter = 0;
  std::optional<Triad> rate_degps;             // navigation block 5, without the Earth's rotation
  std::optional<Triad> raw_rate_degps;         // extended block 2, as measured
  std::optional<Triad> raw_acceleration_mps2;  // navigation block 28, including gravity
  std::optional<Triad> temperature_degC;  // navigation block 25: means of gyros, of accelerometers, board
  std::optional<std::uint32_t> sensor_status;  // navigation block 14, first word
};

inline constexpr std::size_t kChecksum = 4;
// All blocks of all masks, with space for later versions.
inline constexpr std::size_t kLongestTelegram = 2048;

// Reads an intact telegram.
Telegram unpack(std::span<const std::uint8_t> bytes) noexcept;
// Writes the blocks that are set, extended ones from version 3 on; returns the length.
std::size_t pack(const Telegram& telegram, std::span<std::uint8_t, kLongestTelegram> out);

// For the finder of intact frames.
struct Protocol {
  static constexpr std::size_t kLongest = kLongestTelegram;
  static constexpr std::uint8_t kFirst = 'I';

  [[nodiscard]] static framing::Announced at(std::span<const std::uint8_t> bytes) noexcept;
  [[nodiscard]] static bool intact(std::span<const std::uint8_t> telegram) noexcept;
};

}  // namespace ifog::stdbin
