// SPDX-License-Identifier: Apache-2.0
// Detects texts of a serial-to-TCP server: a message before it closes ("Port already in use"), and telnet
// (RFC 854), which doubles each byte FF and inserts commands.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace ifog {

class ServerWords {
 public:
  void connected() noexcept { *this = {}; }
  void came(std::span<const std::uint8_t> bytes) noexcept {
    if (length_ < text_.size())
      std::copy_n(bytes.begin(), std::min(bytes.size(), text_.size() - length_), text_.begin() + length_);
    length_ += bytes.size();
    if (runs_ < kShow) count_runs(bytes);
  }
  // All received bytes if they are a sentence; else "".
  [[nodiscard]] std::string_view sentence() const noexcept {
    std::string_view text(text_.data(), std::min(length_, text_.size()));
    while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.remove_suffix(1);
    const auto spoken = [](char c) { return (c >= ' ' && c <= '~') || c == '\r' || c == '\n' || c == '\t'; };
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
    const bool words = length_ <= text_.size() && std::ranges::all_of(text, spoken) &&
                       2 * std::ranges::count_if(text, letter) > static_cast<long>(text.size());
    return words ? text : std::string_view();
  }
  // True if it started with a telnet command, or doubled every FF.
  [[nodiscard]] bool telnet() const noexcept {
    const auto at = [this](std::size_t i) { return static_cast<std::uint8_t>(text_[i]); };
    const bool command = length_ >= 3 && at(0) == 0xFF && at(1) >= 0xFB && at(1) <= 0xFE && at(2) < 0x40;
    return command || (runs_ >= kShow && odd_ == 0);
  }

 private:
  static constexpr int kShow = 32;  // runs of FF; without doubling half of them are odd

  void count_runs(std::span<const std::uint8_t> bytes) noexcept {
    for (const std::uint8_t byte : bytes) {
      if (byte == 0xFF) {
        ++run_;
      } else if (run_ > 0) {
        ++runs_;
        odd_ += run_ % 2;
        run_ = 0;
      }
    }
  }

  std::array<char, 200> text_{};
  std::size_t length_ = 0;
  int run_ = 0, runs_ = 0, odd_ = 0;
};

}  // namespace ifog
