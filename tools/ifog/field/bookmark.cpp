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

template <typename Io, Is<Bookmark> T>
void fields(Io& io, T& of) {
  io("sensor", of.sensor);
  io("until", of.until);
  io("when", of.when);
  io("said", of.said);
}

std::optional<Bookmark> read_bookmark(const std::string& state, const std::string& sensor) {
  const std::string path = path_of(state, sensor);
  const std::optional<nlohmann::json> file = read_state_json(path, kNightSchema);
  if (!file) return std::nullopt;
  return with_keys(path, [&]() -> std::optional<Bookmark> { return from_json<Bookmark>(*file); });
}

void write_bookmark(const std::string& state, const Bookmark& bookmark) {
  write_state_json(path_of(state, bookmark.sensor), kNightSchema, bookmark);
}

}  // namespace ifog::tools
