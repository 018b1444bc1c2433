// SPDX-License-Identifier: Apache-2.0
// The --json option of every command.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "drivers/capture/files/output_file.h"

namespace ifog::tools {

// Invalid UTF-8 in names from files becomes U+FFFD.
template <typename Json>
void write_json(const std::string& path, const Json& json, int indent = 2) {
  write_file(path, json.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace ifog::tools
