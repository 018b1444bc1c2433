#include "drivers/plugins/kvh1750/crc32_mpeg2.h"

#include <array>

namespace ifog::kvh {
namespace {

constexpr std::uint32_t kPolynomial = 0x04C11DB7U;

constexpr std::array<std::uint32_t, 256> remainders() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t remainder = byte << 24U;
    for (int bit = 0; bit < 8; ++bit)
      remainder = (remainder & 0x80000000U) != 0 ? (remainder << 1U) ^ kPolynomial : remainder << 1U;
    table[byte] = remainder;
  }
  return table;
}

constexpr std::array<std::uint32_t, 256> kRemainders = remainders();

}  // namespace

std::uint32_t crc32_mpeg2(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const std::uint8_t byte : bytes) crc = (crc << 8U) ^ kRemainders[(crc >> 24U) ^ byte];
  return crc;
}

}  // namespace ifog::kvh
