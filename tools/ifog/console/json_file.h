// SPDX-License-Identifier: Apache-2.0
// JSON as text, and the --json option of every command.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "drivers/capture/files/output_file.h"

namespace ifog::tools {

// NaN and infinity become null, invalid UTF-8 in names from files U+FFFD. indent: −1 for a single line.
template <typename Json>
std::string json_text(const Json& json, int indent = 2) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

template <typename Json>
void write_json(const std::string& path, const Json& json, int indent = 2) {
  write_file(path, json_text(json, indent) + "\n");
}

}  // namespace ifog::tools
