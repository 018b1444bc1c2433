// SPDX-License-Identifier: Apache-2.0
// Structs as JSON and back, by one list of their fields:
//
//   template <typename Io, Is<ModelName> T>
//   void fields(Io& io, T& of) {
//     io("identity", of.identity);
//     io("sha256", of.sha256);
//   }
#pragma once

#include <concepts>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "drivers/capture/files/output_file.h"

namespace ifog::tools {

template <typename T, typename Of>
concept Is = std::same_as<std::remove_const_t<T>, Of>;

// The library writes NaN and infinity as null; for a bound, null means unbounded.
class FieldsWriter {
 public:
  template <typename T>
  void operator()(const char* key, const T& value) {
    json[key] = of(value);
  }
  void or_unbounded(const char* key, double value) { (*this)(key, value); }
  template <typename T>
  void if_there(const char* key, const std::optional<T>& value) {
    if (value) json[key] = of(*value);
  }

  template <typename T>
  static nlohmann::ordered_json of(const T& value) {
    if constexpr (requires(FieldsWriter io) { fields(io, value); }) {
      FieldsWriter io;
      fields(io, value);
      return io.json;
    } else {
      return value;
    }
  }
  template <typename T>
  static nlohmann::ordered_json of(const std::optional<T>& value) {
    return value ? of(*value) : nlohmann::ordered_json(nullptr);
  }
  template <typename T>
  static nlohmann::ordered_json of(const std::vector<T>& values) {
    auto out = nlohmann::ordered_json::array();
    for (const T& value : values) out.push_back(of(value));
    return out;
  }

  nlohmann::ordered_json json = nlohmann::ordered_json::object();
};

// Throws nlohmann::json::exception.
class FieldsReader {
 public:
  explicit FieldsReader(const nlohmann::json& json) : json_(json) {}

  template <typename T>
  void operator()(const char* key, T& value) const {
    read(json_.at(key), value);
  }
  void or_unbounded(const char* key, double& value) const {
    const nlohmann::json& there = json_.at(key);
    value = there.is_null() ? std::numeric_limits<double>::infinity() : there.get<double>();
  }
  template <typename T>
  void if_there(const char* key, std::optional<T>& value) const {
    if (json_.contains(key)) read(json_.at(key), value.emplace());
  }

  template <typename T>
  static void read(const nlohmann::json& json, T& value) {
    if constexpr (requires(const FieldsReader io) { fields(io, value); }) {
      const FieldsReader io(json);
      fields(io, value);
    } else {
      value = json.get<T>();
    }
  }
  template <typename T>
  static void read(const nlohmann::json& json, std::optional<T>& value) {
    value.reset();
    if (!json.is_null()) read(json, value.emplace());
  }
  template <typename T>
  static void read(const nlohmann::json& json, std::vector<T>& values) {
    values.clear();
    for (const nlohmann::json& each : json) read(each, values.emplace_back());
  }

 private:
  const nlohmann::json& json_;
};

template <typename T>
nlohmann::ordered_json as_json(const T& value) {
  return FieldsWriter::of(value);
}

// The schema's name, followed by the fields of `what`.
template <typename T>
nlohmann::ordered_json with_schema(const char* schema, const T& what) {
  nlohmann::ordered_json out{{"schema", schema}};
  out.update(as_json(what));
  return out;
}

template <typename T>
T from_json(const nlohmann::json& json) {
  T out{};
  FieldsReader::read(json, out);
  return out;
}

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
