// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "drivers/capture/capture.h"
#include "tests/unit/refusal.h"

namespace ifog {

// What a text is refused with, or "accepted".
inline std::string refusal_of(const std::string& text, const CsvLayout& layout = {}) {
  return test::refusal([&] { parse_capture(text, "a.csv", layout); });
}

}  // namespace ifog
