// SPDX-License-Identifier: Apache-2.0
// Channel of an effect: a column, or the difference of two, "A - B". Column names contain no blanks.
#pragma once

#include <string>
#include <string_view>

namespace ifog {

struct ChannelNames {
  std::string of, less;  // less: "" for a column
};

inline constexpr std::string_view kLess = " - ";

[[nodiscard]] inline std::string difference_of(std::string_view of, std::string_view less) {
  return std::string(of) + std::string(kLess) + std::string(less);
}

[[nodiscard]] inline ChannelNames names_in(std::string_view channel) {
  const auto at = channel.find(kLess);
  if (at == std::string_view::npos) return {std::string(channel), ""};
  return {std::string(channel.substr(0, at)), std::string(channel.substr(at + kLess.size()))};
}

}  // namespace ifog
