// SPDX-License-Identifier: Apache-2.0
// Quotes words of shell commands that are printed for copying or stored.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

#include "drivers/ifog/quoted.h"

namespace ifog {

// Word quoted for a shell unless it is a plain name. Non-printable characters as $'\033' (bash, zsh, ksh;
// POSIX since 2024).
inline std::string shell_word(std::string_view word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string_view::npos) return std::string(word);
  std::string out;
  bool all_seen = true;
  for (std::size_t at = 0; at < word.size();) {
    const std::size_t length = quoting::visible(word.substr(at, 4));
    const auto byte = static_cast<unsigned char>(word[at]);
    if (length == 0)
      out += {'\\', static_cast<char>('0' + (byte >> 6U)), static_cast<char>('0' + (byte >> 3U & 7U)),
              static_cast<char>('0' + (byte & 7U))};
    else
      out += (byte == '\'' || byte == '\\' ? "\\" : "") + std::string(word.substr(at, length));
    all_seen = all_seen && length != 0;
    at += std::max<std::size_t>(length, 1);
  }
  if (!all_seen) return "$'" + out + "'";
  out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// The same for a file name, which must not look like an option: "./-x.csv".
inline std::string shell_file(std::string_view path) {
  const bool dashed = path.size() > 1 && path.front() == '-';
  return shell_word((dashed ? "./" : "") + std::string(path));
}

}  // namespace ifog
