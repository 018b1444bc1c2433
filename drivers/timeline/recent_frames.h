// SPDX-License-Identifier: Apache-2.0
// Counter positions and values of the last accepted frames, to recognise duplicates, overtaken frames and
// frames of another device.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>

namespace ifog {

class RecentFrames {
 public:
  enum class Had : std::uint8_t { no, same, other };
  static constexpr std::uint64_t kMost = 64;

  static std::uint64_t digest_of(std::span<const double> values) noexcept {
    std::uint64_t out = 0x9E3779B97F4A7C15U;
    for (const double value : values) {
      out = (out ^ std::bit_cast<std::uint64_t>(value)) * 0xD6E8FEB86659FD93U;
      out ^= out >> 32U;
    }
    return out;
  }

  [[nodiscard]] std::uint64_t size() const noexcept { return std::min(kept_, kMost); }
  // Tells if a frame was accepted `back` samples before the last one, with the same or other values.
  [[nodiscard]] Had had(std::uint64_t back, std::uint64_t digest) const noexcept {
    Had out = Had::no;
    for (std::uint64_t i = 0; i < size(); ++i)
      if (frames_[i].first + back == place_) out = frames_[i].second == digest ? Had::same : Had::other;
    return out;
  }
  // Adds the next frame, `samples` after the last one.
  void keep(std::uint64_t samples, std::uint64_t digest) noexcept {
    place_ += samples;
    frames_[kept_++ % kMost] = {place_, digest};
  }
  void forget() noexcept { kept_ = 0; }

 private:
  std::uint64_t place_ = 0, kept_ = 0;  // unwrapped counter; number of frames
  std::array<std::pair<std::uint64_t, std::uint64_t>, kMost> frames_{};
};

}  // namespace ifog
