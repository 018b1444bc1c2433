// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/field/proposal.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "daemon/sensor/sensor_parts.h"
#include "daemon/state/state_folder.h"
#include "filters/model_file/sha256.h"
#include "filters/units/field_units.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/field/state_json.h"

namespace ifog::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProposalSchema = "ifog.proposal/1";
constexpr std::string_view kEnding = ".proposal.json";

std::string index_path(const std::string& state, const std::string& sensor) {
  return (fs::path(state) / (sensor + std::string(kEnding))).string();
}

std::string inside(const std::string& state, const std::string& file) {
  return (fs::path(state) / file).string();
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

}  // namespace

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Proposal, sensor, made, why, against, model, model_file, report_file, gain)

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

namespace {

// The proposal in the index; nullopt also if it cannot be read.
std::optional<Proposal> waiting(const std::string& state, const std::string& sensor) {
  try {
    return read_proposal(state, sensor);
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

}  // namespace

void write_proposal(const std::string& state, const Proposal& proposal, const Model& model,
                    const std::string& report) {
  try {
    write_state_file(inside(state, proposal.model_file), model_text(model));
    write_state_file(inside(state, proposal.report_file), report);
    write_state_json(index_path(state, proposal.sensor), kProposalSchema, proposal);
  } catch (...) {
    // Files that no index names would never be removed.
    remove_others(state, proposal.sensor, waiting(state, proposal.sensor));
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

}  // namespace ifog::tools
