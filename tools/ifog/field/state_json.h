// SPDX-License-Identifier: Apache-2.0
// JSON files of the state folder: checked strictly when read, written as a whole.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "daemon/state/state_folder.h"
#include "tools/ifog/console/json.h"

namespace ifog::tools {

// Discarded value if the text is not JSON. Throws std::runtime_error with one line if it is nested too deep.
[[nodiscard]] nlohmann::json parse_json(const std::string& text, const std::string& path);

// nullopt: no such file. Throws std::runtime_error with one line: unreadable, not JSON, another schema.
[[nodiscard]] std::optional<nlohmann::json> read_state_json(const std::string& path,
                                                            const std::string& schema);

template <typename T>
void write_state_json(const std::string& path, const char* schema, const T& what) {
  write_state_file(path, json_text(with_schema(schema, what)) + "\n");
}

// Throws std::runtime_error with one line: the file and its error.
[[noreturn]] void refuse_keys(const std::string& path, const nlohmann::json::exception& error);

// Calls `read`; a wrong or missing key becomes one line with the file's name.
template <typename Read>
auto with_keys(const std::string& path, Read&& read) {
  try {
    return read();
  } catch (const nlohmann::json::exception& error) {
    refuse_keys(path, error);
  }
}

}  // namespace ifog::tools
