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

// null: no such file. Throws std::runtime_error with one line: unreadable, not JSON, another schema.
[[nodiscard]] nlohmann::json read_state_json(const std::string& path, const std::string& schema);

// Throws std::runtime_error with one line: the file and its error.
[[noreturn]] void refuse_keys(const std::string& path, const nlohmann::json::exception& error);

// A struct (console/json.h); nullopt: no such file. Throws as above, also for a wrong or missing key.
template <typename T>
std::optional<T> read_state(const std::string& path, const std::string& schema) try {
  const nlohmann::json file = read_state_json(path, schema);
  return file.is_null() ? std::nullopt : std::optional(file.get<T>());
} catch (const nlohmann::json::exception& error) {
  refuse_keys(path, error);
}

template <typename T>
void write_state_json(const std::string& path, const char* schema, const T& what) {
  write_state_file(path, json_text(with_schema(schema, what)) + "\n");
}

}  // namespace ifog::tools
