// SPDX-License-Identifier: Apache-2.0
// Whole captures in memory, as tests read them.
#pragma once

#include <string>
#include <string_view>

#include "drivers/capture/capture.h"
#include "drivers/capture/capture_builder.h"
#include "tests/unit/refusal.h"

namespace ifog {

inline Capture read_capture(const std::string& path) {
  InputFile file(path);
  return capture_of(read_table(file), path);
}
// The same for a text; `path` names it in messages.
inline Capture parse_capture(std::string_view text, const std::string& path, const CsvLayout& layout = {}) {
  InputFile file(path, std::string(text));
  return capture_of(read_table(file, layout), path);
}

// What a text is refused with, or "accepted".
inline std::string refusal_of(const std::string& text, const CsvLayout& layout = {}) {
  return test::refusal([&] { parse_capture(text, "a.csv", layout); });
}

namespace test {

// A builder whose rows become a capture.
struct Built : private Table, private TableSink, CaptureBuilder {
  explicit Built(const ifog_description& description, const std::vector<std::string>& outside = {})
      : TableSink(static_cast<Table&>(*this)),
        CaptureBuilder(description, static_cast<RowSink&>(*this), outside) {}
  Capture finish() {
    CaptureBuilder::finish();
    return known_part_of(std::move(static_cast<Table&>(*this)), "");
  }
};

}  // namespace test
}  // namespace ifog
