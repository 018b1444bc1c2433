// SPDX-License-Identifier: Apache-2.0
// Words of a command that is printed to be copied, or kept to be run again. The one home of this rule.
#pragma once

#include <string>
#include <string_view>

namespace ifog {

// A word as a shell takes it again, whatever it holds: in quotes unless it is a plain name.
inline std::string shell_word(std::string_view word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string_view::npos) return std::string(word);
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// The same for a file, which an option's dashes would not be taken for: "./-x.csv".
inline std::string shell_file(std::string_view path) {
  const bool dashed = path.size() > 1 && path.front() == '-';
  return shell_word((dashed ? "./" : "") + std::string(path));
}

}  // namespace ifog
