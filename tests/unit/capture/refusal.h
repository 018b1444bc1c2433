// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

#include "drivers/capture/capture.h"

namespace ifog {

// What a text is refused with, or "accepted".
inline std::string refusal_of(const std::string& text, const CsvLayout& layout = {}) {
  try {
    parse_capture(text, "a.csv", layout);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace ifog
