// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/field/proposal.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include "daemon/sensor/sensor_parts.h"
#include "daemon/state/state_folder.h"
#include "filters/model_file/sha256.h"
#include "filters/units/field_units.h"
#include "tools/ifog/field/state_json.h"

namespace ifog::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using nlohmann::ordered_json;

constexpr const char* kProposalSchema = "ifog.proposal/1";
constexpr std::string_view kEnding = ".proposal.json";

std::string index_path(const std::string& state, const std::string& sensor) {
  return (fs::path(state) / (sensor + std::string(kEnding))).string();
}

std::string inside(const std::string& state, const std::string& file) {
  return (fs::path(state) / file).string();
}

// A file that the index names lies in the same folder and nowhere else.
std::string plain_name(const json& from, const std::string& path) {
  auto name = from.get<std::string>();
  if (name.empty() || name != fs::path(name).filename().string())
    throw std::runtime_error(path + ": names a file outside of its folder");
  return name;
}

// Models and pages of proposals that are no longer waiting.
void remove_others(const std::string& state, const std::string& sensor, const std::optional<Proposal>& kept) {
  const std::string prefix = sensor + ".proposal-";
  for (const std::string& name : names_in_state_folder(state))
    if (name.starts_with(prefix) && (!kept || (name != kept->model_file && name != kept->report_file))) try {
        remove_state_file(inside(state, name));
      } catch (const std::runtime_error&) {  // no file of ours: the others go all the same
      }
}

// A number that JSON may hold as null, which stands for no bound.
double number_from(const json& from) {
  return from.is_null() ? std::numeric_limits<double>::infinity() : from.get<double>();
}

}  // namespace

ordered_json as_json(const ModelName& name) { return {{"identity", name.identity}, {"sha256", name.sha256}}; }

ModelName name_from(const json& from) {
  return {from.at("identity").get<std::string>(), from.at("sha256").get<std::string>()};
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

ordered_json gain_json(const std::vector<AxisGain>& gain) {
  ordered_json out = ordered_json::array();
  for (const AxisGain& each : gain) {
    ordered_json errors = ordered_json::array();
    for (const ErrorOfMeans& error : each.kept.errors)
      errors.push_back({{"averaging_s", error.averaging_s},
                        {"means", error.means},
                        {"before_radps", error.before_radps},
                        {"after_radps", error.after_radps}});
    ordered_json share_error = nullptr;
    if (std::isfinite(each.kept.share_error)) share_error = each.kept.share_error;
    out.push_back({{"axis", each.axis},
                   {"seconds", each.kept.seconds},
                   {"share", each.kept.share},
                   {"share_std_error", share_error},
                   {"errors", errors}});
  }
  return out;
}

std::vector<AxisGain> gain_of(const json& from) {
  std::vector<AxisGain> out;
  for (const json& each : from) {
    AxisGain gain;
    gain.axis = each.at("axis").get<std::string>();
    gain.kept.seconds = each.at("seconds").get<double>();
    gain.kept.share = each.at("share").get<double>();
    gain.kept.share_error = number_from(each.at("share_std_error"));
    for (const json& error : each.at("errors"))
      gain.kept.errors.push_back({error.at("averaging_s").get<double>(), error.at("means").get<std::size_t>(),
                                  error.at("before_radps").get<double>(),
                                  error.at("after_radps").get<double>()});
    out.push_back(std::move(gain));
  }
  return out;
}

std::string gain_text(const std::vector<AxisGain>& gain) {
  std::string out;
  for (const AxisGain& each : gain) {
    const auto ratio = [](const ErrorOfMeans& error) {
      return error.before_radps > 0.0 ? error.after_radps / error.before_radps : 1.0;
    };
    const auto best =
        std::min_element(each.kept.errors.begin(), each.kept.errors.end(),
                         [&](const ErrorOfMeans& a, const ErrorOfMeans& b) { return ratio(a) < ratio(b); });
    if (best == each.kept.errors.end()) continue;
    char text[160];
    std::snprintf(text, sizeof text, "%s%s%sRMS of %g s means %.4g -> %.4g °/h", out.empty() ? "" : ", ",
                  each.axis.c_str(), each.axis.empty() ? "" : ": ", best->averaging_s,
                  best->before_radps / kDegreePerHour, best->after_radps / kDegreePerHour);
    out += text;
  }
  return out;
}

namespace {

// The proposal that the index names; one that cannot be read names nothing.
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
  const ordered_json index = {{"schema", kProposalSchema},
                              {"sensor", proposal.sensor},
                              {"made", proposal.made},
                              {"why", proposal.why},
                              {"against", as_json(proposal.against)},
                              {"model", as_json(proposal.model)},
                              {"model_file", proposal.model_file},
                              {"report_file", proposal.report_file},
                              {"gain", gain_json(proposal.gain)}};
  try {
    write_state_file(inside(state, proposal.model_file), model_text(model));
    write_state_file(inside(state, proposal.report_file), report);
    write_state_file(index_path(state, proposal.sensor),
                     index.dump(2, ' ', false, json::error_handler_t::replace) + "\n");
  } catch (...) {
    // What no index names would lie there for ever.
    remove_others(state, proposal.sensor, waiting(state, proposal.sensor));
    throw;
  }
  remove_others(state, proposal.sensor, proposal);
}

std::optional<Proposal> read_proposal(const std::string& state, const std::string& sensor) {
  const std::string path = index_path(state, sensor);
  const std::optional<json> index = read_state_json(path, kProposalSchema);
  if (!index) return std::nullopt;
  return with_keys(path, [&]() -> std::optional<Proposal> {
    Proposal out;
    out.sensor = index->at("sensor").get<std::string>();
    if (out.sensor != sensor) throw std::runtime_error(path + ": belongs to another sensor");
    out.made = index->at("made").get<std::string>();
    out.why = index->at("why").get<std::string>();
    out.against = name_from(index->at("against"));
    out.model = name_from(index->at("model"));
    out.model_file = plain_name(index->at("model_file"), path);
    out.report_file = plain_name(index->at("report_file"), path);
    out.gain = gain_of(index->at("gain"));
    return out;
  });
}

Model proposed_model(const std::string& state, const Proposal& proposal) {
  const std::string path = inside(state, proposal.model_file);
  Model model = parsed_state_file(path, parse_model);
  if (name_of(model).sha256 != proposal.model.sha256)
    throw std::runtime_error(path + ": is another model than the proposal says, expected " +
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
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace ifog::tools
