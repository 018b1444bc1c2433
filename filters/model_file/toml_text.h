// SPDX-License-Identifier: Apache-2.0
// Values in TOML syntax.
#pragma once

#include <array>
#include <charconv>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>

namespace ifog {

// Shortest text that reads back as the same double.
inline std::string toml_number(double value) {
  if (value != value) return "nan";
  std::array<char, 40> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  std::string number(text.data(), end);
  // Without a point it would be an integer, which TOML limits to 64 bits.
  constexpr double kExact = 9007199254740992.0;  // 2^53, largest exact integer
  if (value > kExact || value < -kExact)
    if (number.find_first_of(".ei") == std::string::npos) number += ".0";
  return number;
}

inline std::string toml_quoted(std::string_view value) {
  std::string text = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') {
      text += '\\';
      text += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      std::array<char, 8> escape{};
      std::snprintf(escape.data(), escape.size(), "\\u%04x", static_cast<unsigned>(c));
      text += escape.data();
    } else {
      text += c;
    }
  }
  return text + '"';
}

inline std::string toml_list(std::span<const double> values) {
  std::string text = "[";
  for (std::size_t i = 0; i < values.size(); ++i) text += (i ? ", " : "") + toml_number(values[i]);
  return text + "]";
}

}  // namespace ifog
