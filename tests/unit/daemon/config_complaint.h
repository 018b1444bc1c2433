// SPDX-License-Identifier: Apache-2.0
// What is said of a configuration that is refused; nothing of a good one.
#pragma once

#include "daemon/config/config.h"
#include "tests/unit/test.h"

namespace ifog {

inline std::string complaint(const std::string& text) {
  return test::refusal([&] { parse_config(text, "f.toml"); }, "");
}

}  // namespace ifog
