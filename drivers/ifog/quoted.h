// SPDX-License-Identifier: Apache-2.0
// Quotes foreign text in messages: limited in length, without characters that a terminal or log would
// interpret. Header only, so that out-of-tree plugins quote in the same way.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace ifog {

inline constexpr std::size_t kLongestQuote = 60;      // a value, a name, the beginning of a line
inline constexpr std::size_t kLongestMessage = 2000;  // a whole message that quotes others

namespace quoting {

// Length of the valid, printable UTF-8 sequence (RFC 3629) at the start of `text`, else 0. Not printable:
// control characters including C1, and those that change direction, break lines or have no width
// (U+200B-200F, 2028-202E, 2060-206F, FEFF).
inline std::size_t visible(std::string_view text) noexcept {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::uint32_t first = byte(0);
  if (first < 0x80) return first >= 0x20 && first != 0x7F ? 1 : 0;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  std::uint32_t point = first & (0x7FU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return 0;
    point = point << 6U | (byte(i) & 0x3FU);
  }
  constexpr std::uint32_t kLowest[] = {0, 0, 0x80, 0x800, 0x10000};
  if (point < kLowest[length] || point > 0x10FFFF || (point >= 0xD800 && point <= 0xDFFF)) return 0;
  const auto within = [&](std::uint32_t from, std::uint32_t to) { return from <= point && point <= to; };
  if (within(0x80, 0x9F) || within(0x200B, 0x200F) || within(0x2028, 0x202E) || within(0x2060, 0x206F) ||
      point == 0xFEFF)
    return 0;
  return length;
}

}  // namespace quoting

// At most about `longest` bytes of the text, then "… (N bytes)". Line end and tab as \n and \t, other
// non-printable bytes as \xNN.
inline std::string printable(std::string_view text, std::size_t longest = kLongestQuote) {
  constexpr std::string_view kHex = "0123456789abcdef";
  std::string out;
  out.reserve(std::min(text.size(), longest) + 8);
  for (std::size_t at = 0; at < text.size();) {
    if (out.size() >= longest) return out + "… (" + std::to_string(text.size()) + " bytes)";
    const std::size_t length = quoting::visible(text.substr(at, 4));
    if (length != 0) {
      out += text.substr(at, length);
      at += length;
      continue;
    }
    const auto byte = static_cast<unsigned char>(text[at++]);
    if (byte == '\n')
      out += "\\n";
    else if (byte == '\t')
      out += "\\t";
    else
      out += {'\\', 'x', kHex[byte >> 4U], kHex[byte & 15U]};
  }
  return out;
}

inline std::string in_quotes(std::string_view text, std::size_t longest = kLongestQuote) {
  return "'" + printable(text, longest) + "'";
}

}  // namespace ifog
