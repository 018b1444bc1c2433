// SPDX-License-Identifier: Apache-2.0
// JSON files of the state folder: read strictly, written whole.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "daemon/state/state_folder.h"
#include "tools/ifog/console/listed_fields.h"

namespace ifog::tools {

// Discarded where the text is no JSON. Throws std::runtime_error with one line: nested deeper than any file of ours.
[[nodiscard]] nlohmann::json parse_json(const std::string& text, const std::string& path);

// Nothing: no such file. Throws std::runtime_error with one line: unreadable, no JSON, another schema.
[[nodiscard]] std::optional<nlohmann::json> read_state_json(const std::string& path,
                                                            const std::string& schema);

// The fields of `what` behind the schema's name.
template <typename T>
void write_state_json(const std::string& path, const char* schema, const T& what) {
  nlohmann::ordered_json file{{"schema", schema}};
  file.update(as_json(what));
  write_state_file(path, file.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

// Throws std::runtime_error with one line: the file and what is wrong in it.
[[noreturn]] void refuse_keys(const std::string& path, const nlohmann::json::exception& error);

// `read` of what a file says, a wrong or missing key as one line with the file's name.
template <typename Read>
auto with_keys(const std::string& path, Read&& read) {
  try {
    return read();
  } catch (const nlohmann::json::exception& error) {
    refuse_keys(path, error);
  }
}

}  // namespace ifog::tools
