// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/field/state_json.h"

#include <filesystem>
#include <stdexcept>

#include "daemon/state/state_file.h"
#include "drivers/ifog/quoted.h"

namespace ifog::tools {
namespace {

// Far more than any file of ours has, and far less than the stack of a parser that calls itself holds.
void require_depth(const std::string& path, std::string_view text) {
  constexpr std::size_t kMostDepth = 64;
  std::size_t depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      quoted = c != '"';
    } else if (c == '"') {
      quoted = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kMostDepth)
        throw std::runtime_error(path +
                                 ": is JSON nested deeper than 64, which no file of the state folder is");
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
}

}  // namespace

std::optional<nlohmann::json> read_state_json(const std::string& path, const std::string& schema) {
  std::error_code none;
  if (!std::filesystem::exists(path, none)) return std::nullopt;
  constexpr std::size_t kMost = std::size_t{64} << 20U;  // bytes; a history of a year of nights has 1 MB
  const std::string text = read_state_file(path, kMost);
  require_depth(path, text);
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object())
    throw std::runtime_error(path + ": is no JSON object, expected schema " + schema);
  const auto found = json.find("schema");
  if (found == json.end() || *found != schema)
    throw std::runtime_error(
        path + ": schema = " +
        (found == json.end()
             ? "(missing)"
             : printable(found->dump(-1, ' ', true, nlohmann::json::error_handler_t::replace))) +
        ", expected " + schema);
  return json;
}

void refuse_keys(const std::string& path, const nlohmann::json::exception& error) {
  // Behind the library's own "[json.exception.out_of_range.403] ".
  const std::string what = error.what();
  const std::size_t words = what.find("] ");
  throw std::runtime_error(
      path + ": damaged: " + printable(words == std::string::npos ? what : what.substr(words + 2)));
}

}  // namespace ifog::tools
