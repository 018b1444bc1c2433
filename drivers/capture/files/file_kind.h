// SPDX-License-Identifier: Apache-2.0
// Kind of a file by its ending (in any case) and first bytes, and how to convert files of other programs.
#pragma once

#include <boost/algorithm/string/predicate.hpp>
#include <string>
#include <string_view>

namespace ifog {

inline bool is_packed_name(std::string_view name) { return boost::iends_with(name, ".gz"); }

inline std::string_view unpacked_name(std::string_view name) {
  if (is_packed_name(name)) name.remove_suffix(3);
  return name;
}

// How to convert a text of another program to a table: UTF-16, YAML, JSON in records, several samples per
// line; "" if it may be a table.
[[nodiscard]] std::string foreign_text(std::string_view head);

// Excel's "Unicode text".
constexpr bool begins_as_utf16(std::string_view head) {
  return head.starts_with("\xFF\xFE") || head.starts_with("\xFE\xFF");
}

// How to convert another program's CAN log to a candump log; "" if it is none.
[[nodiscard]] std::string foreign_can_log(std::string_view head);

// How to convert another program's container (spreadsheet, MATLAB before 7.3, ROS, PX4, ArduPilot, NumPy),
// detected by its first bytes; "" if it is none.
[[nodiscard]] std::string foreign_container(std::string_view head);

}  // namespace ifog
