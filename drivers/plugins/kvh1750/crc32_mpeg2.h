// CRC-32/MPEG-2: polynomial 0x04C11DB7, starts at 0xFFFFFFFF, most significant bit first, not inverted at the
// end. Check value for "123456789": 0x0376E6E7 (catalogue of parametrised CRC algorithms).
#pragma once

#include <cstdint>
#include <span>

namespace ifog::kvh {

std::uint32_t crc32_mpeg2(std::span<const std::uint8_t> bytes) noexcept;

}  // namespace ifog::kvh
