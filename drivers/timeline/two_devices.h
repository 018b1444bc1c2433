// SPDX-License-Identifier: Apache-2.0
// Detects two devices on one line or bus: the sequence alternates between two counts that each grow by one.
// Neither can be chosen.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace ifog {

class TwoDevices {
 public:
  [[nodiscard]] bool found() const noexcept { return found_; }
  [[nodiscard]] bool suspected() const noexcept { return crossed_ > 0; }
  // Adds the next frame's count. own: it is of the tracked device although it does not continue its count.
  void saw(std::uint32_t sequence, std::uint64_t modulus, bool own) noexcept {
    const auto continues = [&](std::uint32_t one) { return (one + std::uint64_t{1}) % modulus == sequence; };
    if (sequence == last_) return;
    const std::uint32_t before = std::exchange(last_, sequence);
    plain_ = continues(before) ? plain_ + 1 : 0;
    if (plain_ >= kGone) found_ = false;
    if (own || plain_ >= kGone) crossed_ = 0;
    if (plain_ > 0) return;
    if (!own && std::ranges::any_of(ends_, continues)) ++crossed_;
    found_ = found_ || crossed_ >= kShows;
    std::rotate(ends_.begin(), ends_.end() - 1, ends_.end());
    ends_[0] = before;
  }

 private:
  static constexpr int kShows = 32;  // changes between counts that one device does not make by chance
  static constexpr int kGone = 256;  // consecutive frames: the other device was unplugged

  std::uint32_t last_ = 0;
  std::array<std::uint32_t, 3> ends_{};  // of the last runs of consecutive counts
  int plain_ = 0, crossed_ = 0;
  bool found_ = false;
};

}  // namespace ifog
