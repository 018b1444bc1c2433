// SPDX-License-Identifier: Apache-2.0
// What is said of a configuration that is refused; nothing of a good one.
#pragma once

#include "daemon/config/config.h"
#include "tests/unit/test.h"

namespace ifog {

inline std::string complaint(const std::string& text) {
  return test::refusal([&] { parse_config(text, "f.toml"); }, "");
}

// Each of these texts behind `head` is refused in one line, which begins so.
inline void expect_complaints(const std::string& head,
                              const std::vector<std::pair<std::string, std::string>>& wrong) {
  for (const auto& [text, place] : wrong) {
    const std::string said = complaint(head + text);
    EXPECT_TRUE(said.starts_with("f.toml:" + place)) << text << said;
    EXPECT_FALSE(test::has(said, "\n")) << said;
  }
}

}  // namespace ifog
