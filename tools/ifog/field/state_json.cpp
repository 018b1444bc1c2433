// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/field/state_json.h"

#include "daemon/state/state_folder.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/input_limits.h"
#include "tools/ifog/console/errors.h"

namespace ifog::tools {

nlohmann::json parse_json(const std::string& text, const std::string& path) {
  if (text.size() > kInputLimits.json_bytes) throw refusal("{}: is longer than any JSON of ours", path);
  const auto is_shallow = [&](int depth, auto, auto&) {
    if (static_cast<std::size_t>(depth) >= kInputLimits.json_depth)
      throw refusal("{}: is JSON nested deeper than {}, which no file of ours is", path,
                    kInputLimits.json_depth);
    return true;
  };
  return nlohmann::json::parse(text, is_shallow, false);
}

nlohmann::json read_state_json(const std::string& path, const std::string& schema) {
  const std::optional<std::string> text = state_file(path);
  if (!text) return nullptr;
  nlohmann::json json = parse_json(*text, path);
  if (json.is_discarded() || !json.is_object())
    throw refusal("{}: is no JSON object, expected schema {}", path, schema);
  const auto found = json.find("schema");
  if (found == json.end() || *found != schema)
    throw refusal("{}: schema is {}, expected {}", path,
                  found == json.end()  ? "missing"
                  : found->is_string() ? "another"
                                       : found->type_name(),
                  schema);
  return json;
}

void refuse_keys(const std::string& path, const nlohmann::json::exception& error) {
  // Removes the library's prefix "[json.exception.out_of_range.403] ".
  const std::string what = error.what();
  const std::size_t words = what.find("] ");
  throw refusal("{}: damaged: {}", path,
                printable(words == std::string::npos ? what : what.substr(words + 2)));
}

}  // namespace ifog::tools
