// SPDX-License-Identifier: Apache-2.0
// What a file is, by the end of its name (in small letters or capitals: GYRO.CSV is as much a CSV as gyro.csv) and by
// its first bytes: also what makes a readable one of another program's.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace ifog {

// ending: in small letters, with its point.
constexpr bool has_ending(std::string_view name, std::string_view ending) {
  if (name.size() < ending.size()) return false;
  name.remove_prefix(name.size() - ending.size());
  return std::equal(name.begin(), name.end(), ending.begin(), [](char c, char e) {
    return (c >= 'A' && c <= 'Z' ? static_cast<char>(c + 'a' - 'A') : c) == e;
  });
}

constexpr bool is_packed_name(std::string_view name) { return has_ending(name, ".gz"); }

constexpr std::string_view unpacked_name(std::string_view name) {
  if (is_packed_name(name)) name.remove_suffix(3);
  return name;
}

// What makes a table of a text of another program: UTF-16, YAML, JSON in records, several samples a line; "" for what
// may be a table.
[[nodiscard]] std::string foreign_text(std::string_view head);

// What Excel calls "Unicode text".
constexpr bool begins_as_utf16(std::string_view head) {
  return head.starts_with("\xFF\xFE") || head.starts_with("\xFE\xFF");
}

// What makes a candump log of a CAN log of another program, "" for what is none.
[[nodiscard]] std::string foreign_can_log(std::string_view head);

// What makes columns of a container of another program (a spreadsheet, MATLAB before 7.3, ROS, PX4, ArduPilot, NumPy),
// by its first bytes; "" for what is none.
[[nodiscard]] std::string foreign_container(std::string_view head);

}  // namespace ifog
