// SPDX-License-Identifier: Apache-2.0
// Bytes as manuals print them: "FE81 FF55", capital hexadecimal digits, spaces anywhere.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace ifog {

inline std::vector<std::uint8_t> hex_bytes(std::string_view text) {
  std::vector<std::uint8_t> bytes;
  int high = -1;
  for (const char c : text) {
    if (c == ' ') continue;
    const int digit = c <= '9' ? c - '0' : c - 'A' + 10;
    if (high < 0) {
      high = digit;
    } else {
      bytes.push_back(static_cast<std::uint8_t>(high * 16 + digit));
      high = -1;
    }
  }
  return bytes;
}

}  // namespace ifog
