// SPDX-License-Identifier: Apache-2.0
// JSON of the commands and of their files. A struct that is a JSON object is listed with
// NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE: its members are the keys.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "drivers/capture/files/output_file.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/input_limits.h"
#include "tools/ifog/console/errors.h"

namespace nlohmann {

// null: no value.
template <typename T>
struct adl_serializer<std::optional<T>> {
  template <typename Json>
  static void to_json(Json& out, const std::optional<T>& value) {
    out = value ? Json(*value) : Json(nullptr);
  }
  static void from_json(const json& in, std::optional<T>& value) {
    value.reset();
    if (!in.is_null()) value = in.get<T>();
  }
};

}  // namespace nlohmann

namespace ifog::tools {

// Discarded value if the text is not JSON. Throws std::runtime_error with one line if it is too long or nested
// too deep. path: for messages.
inline nlohmann::json parse_json(const std::string& text, const std::string& path) {
  if (text.size() > kInputLimits.json_bytes) throw refusal("{}: is longer than any JSON of ours", path);
  const auto is_shallow = [&](int depth, auto, auto&) {
    if (static_cast<std::size_t>(depth) >= kInputLimits.json_depth)
      throw refusal("{}: is JSON nested deeper than {}, which no file of ours is", path,
                    kInputLimits.json_depth);
    return true;
  };
  return nlohmann::json::parse(text, is_shallow, false);
}

// Throws std::runtime_error with one line: the file, and the key that is missing or wrong.
[[noreturn]] inline void refuse_keys(const std::string& path, const nlohmann::json::exception& error) {
  // Removes the library's prefix "[json.exception.out_of_range.403] ".
  const std::string what = error.what();
  const std::size_t words = what.find("] ");
  throw refusal("{}: damaged: {}", path,
                printable(words == std::string::npos ? what : what.substr(words + 2)));
}

template <typename T>
nlohmann::json with_schema(const char* schema, const T& what) {
  nlohmann::json out = what;
  out["schema"] = schema;
  return out;
}

// NaN and infinity become null, invalid UTF-8 in names from files U+FFFD. indent: −1 for a single line.
template <typename Json>
std::string json_text(const Json& json, int indent = 2) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

// "": nothing is written.
template <typename Json>
void write_json(const std::string& path, const Json& json, int indent = 2) {
  if (!path.empty()) write_file(path, json_text(json, indent) + "\n");
}

}  // namespace ifog::tools
