// SPDX-License-Identifier: Apache-2.0
// How far the nights have read a sensor's recordings, and what the last one said: NAME.night.json in the
// state folder, schema ifog.night/1.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace ifog::tools {

struct Bookmark {
  std::uint64_t until = 0;  // number of the last recording that was gone through
  std::string when;         // UTC
  std::string said;         // one line
};

// Nothing: no night has been. Throws std::runtime_error with one line: damaged.
[[nodiscard]] std::optional<Bookmark> read_bookmark(const std::string& state, const std::string& sensor);
void write_bookmark(const std::string& state, const std::string& sensor, const Bookmark& bookmark);

}  // namespace ifog::tools
