// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/field/models.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "daemon/sensor/sensor_parts.h"
#include "daemon/state/state_folder.h"
#include "filters/model_file/sha256.h"
#include "filters/units/field_units.h"
#include "tools/ifog/console/errors.h"

namespace ifog {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ErrorOfMeans, averaging_s, means, before_radps, after_radps)
}  // namespace ifog

namespace ifog::tools {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ModelName, identity, sha256)

void to_json(nlohmann::json& json, const AxisGain& gain) {
  json = {{"axis", gain.axis},
          {"seconds", gain.kept.seconds},
          {"share", gain.kept.share},
          {"share_std_error", gain.kept.share_error},
          {"errors", gain.kept.errors}};
}

void from_json(const nlohmann::json& json, AxisGain& gain) {
  json.at("axis").get_to(gain.axis);
  json.at("seconds").get_to(gain.kept.seconds);
  json.at("share").get_to(gain.kept.share);
  // Infinity is written as null.
  const auto error = json.at("share_std_error").get<std::optional<double>>();
  gain.kept.share_error = error.value_or(std::numeric_limits<double>::infinity());
  json.at("errors").get_to(gain.kept.errors);
}

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

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Proposal, sensor, made, why, against, model, model_file, report_file, gain)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Bookmark, sensor, until, when, said)

namespace {

namespace fs = std::filesystem;

constexpr const char *kProposalSchema = "ifog.proposal/1", *kHistorySchema = "ifog.history/1",
                     *kNightSchema = "ifog.night/1";
constexpr const char* kAdopt = "adopt";
constexpr std::string_view kEnding = ".proposal.json";

std::string inside(const std::string& state, const std::string& file) {
  return (fs::path(state) / file).string();
}

std::string index_path(const std::string& state, const std::string& sensor) {
  return inside(state, sensor + std::string(kEnding));
}

std::string bookmark_path(const std::string& state, const std::string& sensor) {
  return inside(state, sensor + ".night.json");
}

// Removes models and pages of proposals that were replaced.
void remove_others(const std::string& state, const std::string& sensor, const std::optional<Proposal>& kept) {
  const std::string prefix = sensor + ".proposal-";
  for (const std::string& name : names_in_state_folder(state))
    if (name.starts_with(prefix) && (!kept || (name != kept->model_file && name != kept->report_file))) try {
        remove_state_file(inside(state, name));
      } catch (const std::runtime_error&) {  // not a file of ours; continue
      }
}

// Files named in the index must be in the same folder.
void require_plain_name(const std::string& name, const std::string& path) {
  if (name.empty() || name != fs::path(name).filename().string())
    throw refusal("{}: names a file outside of its folder", path);
}

struct HistoryFile {
  std::string sensor;
  std::vector<ModelChange> changes;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(HistoryFile, sensor, changes)

// null: no such file. Throws std::runtime_error with one line: unreadable, not JSON, another schema.
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

// nullopt: no such file. Throws as above, also for a wrong or missing key.
template <typename T>
std::optional<T> read_state(const std::string& path, const std::string& schema) try {
  const nlohmann::json file = read_state_json(path, schema);
  return file.is_null() ? std::nullopt : std::optional(file.get<T>());
} catch (const nlohmann::json::exception& error) {
  refuse_keys(path, error);
}

template <typename T>
void write_state_json(const std::string& path, const char* schema, const T& what) {
  write_state_file(path, json_text(with_schema(schema, what)) + "\n");
}

// The proposal in the index; nullopt also if it cannot be read.
std::optional<Proposal> readable_proposal(const std::string& state, const std::string& sensor) try {
  return read_proposal(state, sensor);
} catch (const std::exception&) {
  return std::nullopt;
}

}  // namespace

ModelName name_of(const Model& model) {
  const std::string hash = sha256_hex(model_text(model));
  return {model.identity(), hash};
}

ModelInUse model_in_use(const Field& field, const SensorConfig& sensor) {
  ModelInUse out;
  SensorConfig now = sensor;
  now.model = field.model_path(sensor);
  now.model_adopted = sensor.model_adopted || sensor.model.empty();
  if (!is_in_state_folder(now.model)) return out;
  out.model = *read_sensor_model(now);
  out.name = name_of(*out.model);
  return out;
}

std::string gain_text(const std::vector<AxisGain>& gain) {
  std::string out;
  for (const AxisGain& each : gain) {
    const auto ratio = [](const ErrorOfMeans& error) {
      return error.before_radps > 0.0 ? error.after_radps / error.before_radps : 1.0;
    };
    const auto best = std::ranges::min_element(
        each.kept.errors, [&](const ErrorOfMeans& a, const ErrorOfMeans& b) { return ratio(a) < ratio(b); });
    if (best == each.kept.errors.end()) continue;
    out += fmt::format("{}{}{}RMS of {:g} s means {:.4g} -> {:.4g} °/h", out.empty() ? "" : ", ", each.axis,
                       each.axis.empty() ? "" : ": ", best->averaging_s, best->before_radps / kDegreePerHour,
                       best->after_radps / kDegreePerHour);
  }
  return out;
}

void write_proposal(const std::string& state, const Proposal& proposal, const Model& model,
                    const std::string& report) {
  try {
    write_state_file(inside(state, proposal.model_file), model_text(model));
    write_state_file(inside(state, proposal.report_file), report);
    write_state_json(index_path(state, proposal.sensor), kProposalSchema, proposal);
  } catch (...) {
    // Files that no index names would never be removed.
    remove_others(state, proposal.sensor, readable_proposal(state, proposal.sensor));
    throw;
  }
  remove_others(state, proposal.sensor, proposal);
}

std::optional<Proposal> read_proposal(const std::string& state, const std::string& sensor) {
  const std::string path = index_path(state, sensor);
  std::optional<Proposal> out = read_state<Proposal>(path, kProposalSchema);
  if (!out) return out;
  if (out->sensor != sensor) throw refusal("{}: belongs to another sensor", path);
  require_plain_name(out->model_file, path);
  require_plain_name(out->report_file, path);
  return out;
}

Model proposed_model(const std::string& state, const Proposal& proposal) {
  const std::string path = inside(state, proposal.model_file);
  Model model = parsed_state_file(path, parse_model);
  if (name_of(model).sha256 != proposal.model.sha256)
    throw refusal("{}: is another model than that of the proposal, expected {}", path,
                  proposal.model.identity);
  return model;
}

void remove_proposal(const std::string& state, const std::string& sensor) {
  remove_state_file(index_path(state, sensor));
  remove_others(state, sensor, std::nullopt);
}

std::vector<std::string> sensors_with_proposal(const std::string& state) {
  std::vector<std::string> out;
  for (const std::string& name : names_in_state_folder(state))
    if (name.ends_with(kEnding) && name.size() > kEnding.size())
      out.push_back(name.substr(0, name.size() - kEnding.size()));
  std::ranges::sort(out);
  return out;
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

std::string History::path() const { return inside(state_, sensor_ + ".history.json"); }

std::string History::kept_path(const ModelName& name) const {
  return inside(state_, sensor_ + ".kept-" + fs::path(name.identity).filename().string() + ".toml");
}

std::optional<Bookmark> read_bookmark(const std::string& state, const std::string& sensor) {
  return read_state<Bookmark>(bookmark_path(state, sensor), kNightSchema);
}

void write_bookmark(const std::string& state, const Bookmark& bookmark) {
  write_state_json(bookmark_path(state, bookmark.sensor), kNightSchema, bookmark);
}

}  // namespace ifog::tools
