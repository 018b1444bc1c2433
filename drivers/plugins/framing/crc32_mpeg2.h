// SPDX-License-Identifier: Apache-2.0
// CRC-32/MPEG-2: polynomial 0x04C11DB7, initial value 0xFFFFFFFF, most significant bit first, not inverted.
// Check value of "123456789": 0x0376E6E7 (catalogue of parametrised CRC algorithms).
//
// Processes eight bytes at a time with eight tables (M. E. Kounavis and F. L. Berry, "Novel Table
// Lookup-Based Algorithms for High-Performance CRC Generation", IEEE Transactions on Computers 57(11), 2008);
// byte by byte the dependent look-ups would dominate the decoding time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace ifog::framing {

// By table and byte: remainder of the byte followed by this many zero bytes.
struct Crc32Mpeg2Tables {
  static constexpr std::size_t kTables = 8;
  std::array<std::array<std::uint32_t, 256>, kTables> after{};

  constexpr Crc32Mpeg2Tables() {
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
      std::uint32_t rest = byte << 24U;
      for (int bit = 0; bit < 8; ++bit) rest = rest << 1U ^ ((rest >> 31U) != 0 ? 0x04C11DB7U : 0U);
      after[0][byte] = rest;
    }
    for (std::size_t k = 1; k < kTables; ++k)
      for (std::size_t byte = 0; byte < 256; ++byte)
        after[k][byte] = after[k - 1][byte] << 8U ^ after[0][after[k - 1][byte] >> 24U];
  }
};

inline constexpr Crc32Mpeg2Tables kCrc32Mpeg2;

[[nodiscard]] inline std::uint32_t crc32_mpeg2(std::span<const std::uint8_t> bytes) noexcept {
  const auto& after = kCrc32Mpeg2.after;
  std::uint32_t crc = 0xFFFFFFFFU;
  for (; bytes.size() >= Crc32Mpeg2Tables::kTables; bytes = bytes.subspan(Crc32Mpeg2Tables::kTables)) {
    crc = after[7][crc >> 24U ^ bytes[0]] ^ after[6][(crc >> 16U & 0xFFU) ^ bytes[1]] ^
          after[5][(crc >> 8U & 0xFFU) ^ bytes[2]] ^ after[4][(crc & 0xFFU) ^ bytes[3]] ^ after[3][bytes[4]] ^
          after[2][bytes[5]] ^ after[1][bytes[6]] ^ after[0][bytes[7]];
  }
  for (const std::uint8_t byte : bytes) crc = crc << 8U ^ after[0][crc >> 24U ^ byte];
  return crc;
}

}  // namespace ifog::framing
