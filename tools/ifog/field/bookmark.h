// SPDX-License-Identifier: Apache-2.0
// The last recording that `ifog night` has processed, and its result: NAME.night.json in the state folder,
// schema ifog.night/1.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace ifog::tools {

struct Bookmark {
  std::string sensor;
  std::uint64_t until = 0;  // number of the last processed recording
  std::string when;         // UTC
  std::string said;         // one line
};

// nullopt before the first night. Throws std::runtime_error with one line if the file is damaged.
[[nodiscard]] std::optional<Bookmark> read_bookmark(const std::string& state, const std::string& sensor);
void write_bookmark(const std::string& state, const Bookmark& bookmark);

}  // namespace ifog::tools
