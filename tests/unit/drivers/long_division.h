// SPDX-License-Identifier: Apache-2.0
// CRC-32/MPEG-2 as its definition reads, one bit at a time: no table, nothing shared with the code under test.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace ifog {

inline std::uint32_t long_division(std::span<const std::uint8_t> bytes) {
  std::uint32_t remainder = 0xFFFFFFFFU;
  for (const std::uint8_t byte : bytes)
    for (int bit = 7; bit >= 0; --bit) {
      const bool in = ((byte >> bit) & 1) != 0, out = (remainder >> 31U) != 0;
      remainder <<= 1U;
      if (in != out) remainder ^= 0x04C11DB7U;
    }
  return remainder;
}

// Checksum of the bytes and as many zeros as make them a multiple of `block` bytes, which are not appended.
inline void append_crc32(std::vector<std::uint8_t>& bytes, std::size_t block = 1) {
  std::vector<std::uint8_t> covered = bytes;
  while (covered.size() % block != 0) covered.push_back(0);
  const std::uint32_t crc = long_division(covered);
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(crc >> shift));
}

}  // namespace ifog
