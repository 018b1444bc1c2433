// SPDX-License-Identifier: Apache-2.0
// Frames of a KVH device for the finder of intact frames.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "drivers/plugins/framing/frame_finder.h"
#include "drivers/plugins/kvh1750/frame.h"

namespace ifog::kvh {

struct Protocol {
  static constexpr std::size_t kLongest = kLongestFrame;
  static constexpr std::uint8_t kFirst = 0xFE;

  [[nodiscard]] static framing::Announced at(std::span<const std::uint8_t> bytes) noexcept {
    using Is = framing::Announced::Is;
    constexpr std::array<std::uint8_t, kHeaderLength - 1> kBegin{kFirst, 0x81, 0xFF};
    const std::size_t n = std::min(bytes.size(), kBegin.size());
    if (!std::equal(kBegin.begin(), kBegin.begin() + n, bytes.begin())) return {};
    if (bytes.size() < kHeaderLength) return {Is::unknown_yet};
    const auto format = header_at(bytes);
    return format ? framing::Announced{Is::frame, length_of(*format)} : framing::Announced{};
  }
  [[nodiscard]] static bool intact(std::span<const std::uint8_t> frame) noexcept { return crc_fits(frame); }
};

using FrameFinder = framing::FrameFinder<Protocol>;

// Fields of a found frame.
inline Frame unpack_found(std::span<const std::uint8_t> frame) noexcept {
  return unpack(*header_at(frame), frame);
}

}  // namespace ifog::kvh
