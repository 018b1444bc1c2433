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

// A struct with fields() (console/json.h); nullopt: no such file. Throws as above, also for a wrong or missing key.
template <typename T>
std::optional<T> read_state(const std::string& path, const std::string& schema) {
  const std::optional<nlohmann::json> file = read_state_json(path, schema);
  if (!file) return std::nullopt;
  return with_keys(path, [&] { return std::optional(from_json<T>(*file)); });
}

template <typename T>
void write_state_json(const std::string& path, const char* schema, const T& what) {
  write_state_file(path, json_text(with_schema(schema, what)) + "\n");
}

}  // namespace ifog::tools
