// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/field/bookmark.h"

#include <filesystem>

#include "daemon/state/state_folder.h"
#include "tools/ifog/field/state_json.h"

namespace ifog::tools {
namespace {

constexpr const char* kNightSchema = "ifog.night/1";

std::string path_of(const std::string& state, const std::string& sensor) {
  return (std::filesystem::path(state) / (sensor + ".night.json")).string();
}

}  // namespace

std::optional<Bookmark> read_bookmark(const std::string& state, const std::string& sensor) {
  const std::string path = path_of(state, sensor);
  const std::optional<nlohmann::json> file = read_state_json(path, kNightSchema);
  if (!file) return std::nullopt;
  return with_keys(path, [&]() -> std::optional<Bookmark> {
    return Bookmark{file->at("until").get<std::uint64_t>(), file->at("when").get<std::string>(),
                    file->at("said").get<std::string>()};
  });
}

void write_bookmark(const std::string& state, const std::string& sensor, const Bookmark& bookmark) {
  const nlohmann::ordered_json file{{"schema", kNightSchema},
                                    {"sensor", sensor},
                                    {"until", bookmark.until},
                                    {"when", bookmark.when},
                                    {"said", bookmark.said}};
  write_state_file(path_of(state, sensor),
                   file.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace ifog::tools
