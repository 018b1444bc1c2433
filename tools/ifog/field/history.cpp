// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/field/history.h"

#include <filesystem>

#include "daemon/state/state_folder.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/field/state_json.h"

namespace ifog::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char *kHistorySchema = "ifog.history/1", *kNightSchema = "ifog.night/1";
constexpr const char* kAdopt = "adopt";

struct HistoryFile {
  std::string sensor;
  std::vector<ModelChange> changes;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(HistoryFile, sensor, changes)

std::string path_of(const std::string& state, const std::string& sensor) {
  return (std::filesystem::path(state) / (sensor + ".night.json")).string();
}

}  // namespace

void to_json(nlohmann::json& json, const ModelChange& of) {
  json = {{"what", of.what}, {"when", of.when}, {"model", of.model},    {"replaced", of.replaced},
          {"why", of.why},   {"gain", of.gain}, {"outcome", of.outcome}};
  if (of.recorded) json["recorded"] = *of.recorded;
}

void from_json(const nlohmann::json& json, ModelChange& of) {
  json.at("what").get_to(of.what);
  json.at("when").get_to(of.when);
  json.at("model").get_to(of.model);
  json.at("replaced").get_to(of.replaced);
  json.at("why").get_to(of.why);
  json.at("gain").get_to(of.gain);
  json.at("outcome").get_to(of.outcome);
  if (json.contains("recorded")) json.at("recorded").get_to(of.recorded.emplace());
}

History::History(const std::string& state, const std::string& sensor) : state_(state), sensor_(sensor) {
  if (std::optional<HistoryFile> file = read_state<HistoryFile>(path(), kHistorySchema))
    changes_ = std::move(file->changes);
}

// A revert undoes the latest adoption that is not reverted yet, like nested brackets.
const ModelChange* History::in_force() const {
  std::size_t reverts = 0;
  for (auto change = changes_.rbegin(); change != changes_.rend(); ++change) {
    if (change->what != kAdopt) {
      ++reverts;
    } else if (reverts == 0) {
      return &*change;
    } else {
      --reverts;
    }
  }
  return nullptr;
}

void History::add(ModelChange change, const std::optional<Model>& replaced) {
  if (replaced) write_state_file(kept_path(change.replaced), model_text(*replaced));
  changes_.push_back(std::move(change));
  write();
}

void History::set_outcome(const std::string& outcome) {
  if (changes_.empty()) return;
  changes_.back().outcome = outcome;
  write();
}

void History::take_back() {
  if (changes_.empty()) return;
  changes_.pop_back();
  write();
}

void History::drop_incomplete_change(const ModelName& in_use) {
  if (!changes_.empty() && changes_.back().model != in_use && changes_.back().replaced == in_use) take_back();
}

std::optional<Model> History::kept(const ModelName& name) const {
  if (name.sha256.empty()) return std::nullopt;
  Model model = parsed_state_file(kept_path(name), parse_model);
  if (name_of(model) != name) throw refusal("{}: is another model than {}", kept_path(name), name.identity);
  return model;
}

void History::write() const { write_state_json(path(), kHistorySchema, HistoryFile{sensor_, changes_}); }

std::string History::path() const { return (fs::path(state_) / (sensor_ + ".history.json")).string(); }

std::string History::kept_path(const ModelName& name) const {
  return (fs::path(state_) / (sensor_ + ".kept-" + fs::path(name.identity).filename().string() + ".toml"))
      .string();
}

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Bookmark, sensor, until, when, said)

std::optional<Bookmark> read_bookmark(const std::string& state, const std::string& sensor) {
  return read_state<Bookmark>(path_of(state, sensor), kNightSchema);
}

void write_bookmark(const std::string& state, const Bookmark& bookmark) {
  write_state_json(path_of(state, bookmark.sensor), kNightSchema, bookmark);
}

}  // namespace ifog::tools
