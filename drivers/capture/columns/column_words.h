// SPDX-License-Identifier: Apache-2.0
// A column's name taken apart: "w_RS_S_x [rad s^-1]" is the words w, rs and s of axis x.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace ifog {

// In small letters.
[[nodiscard]] std::string lower(std::string text);

// What a word says of a column; the words of each role, and what the role is, stand in column_words.cpp.
enum class Role { rate, speed, turn, glued, no_rate, truth, step, angle, time, no_time, ms, us, ns, s, one };
[[nodiscard]] bool says(std::string_view word, Role role);

struct Words {
  explicit Words(const std::string& header);

  std::vector<std::string> words;  // in small letters, without the axis, the unit and an index
  std::string axis;                // "x", "y", "z"; "" where the name has none
  std::string stem;                // the words, a blank between them: the same for all axes of a sensor
  std::string text;  // the name without its unit, as a column's name may be: letters, digits, "_"

  [[nodiscard]] bool has(std::string_view word) const;
  [[nodiscard]] bool have(Role role) const;  // one of them at least
  [[nodiscard]] std::string_view first() const { return words.empty() ? std::string_view() : words.front(); }
  [[nodiscard]] std::size_t size() const { return words.size(); }
};

}  // namespace ifog
