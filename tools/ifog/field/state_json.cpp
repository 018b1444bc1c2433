// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/field/state_json.h"

#include <filesystem>
#include <stdexcept>

#include "drivers/capture/output_file.h"
#include "drivers/capture/text_file.h"
#include "drivers/ifog/quoted.h"

namespace ifog::tools {

std::optional<nlohmann::json> read_state_json(const std::string& path, const std::string& schema) {
  std::error_code none;
  if (!std::filesystem::exists(path, none)) return std::nullopt;
  // A FIFO would hold up who reads it.
  if (!std::filesystem::is_regular_file(path, none))
    throw std::runtime_error(path + ": is no regular file, expected JSON of schema " + schema);
  const nlohmann::json json = nlohmann::json::parse(read_text_file(path), nullptr, false);
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

void write_state_file(const std::string& path, std::string_view bytes) {
  std::error_code none;
  const std::filesystem::file_status there = std::filesystem::symlink_status(path, none);
  if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there))
    throw std::runtime_error(path + ": is no regular file, which is not written in a state folder");
  write_file(path, bytes);
}

void refuse_keys(const std::string& path, const nlohmann::json::exception& error) {
  // Behind the library's own "[json.exception.out_of_range.403] ".
  const std::string what = error.what();
  const std::size_t words = what.find("] ");
  throw std::runtime_error(
      path + ": damaged: " + printable(words == std::string::npos ? what : what.substr(words + 2)));
}

}  // namespace ifog::tools
