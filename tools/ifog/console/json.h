// SPDX-License-Identifier: Apache-2.0
// JSON of the commands and of their files. A struct that is a JSON object is listed with
// NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE: its members are the keys.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "drivers/capture/files/output_file.h"

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
