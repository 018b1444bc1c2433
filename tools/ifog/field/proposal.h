// SPDX-License-Identifier: Apache-2.0
// A model that `ifog night` found and that is not adopted yet. At most one per sensor, in the state folder:
//
//   NAME.proposal.json             schema ifog.proposal/1: index; written last and removed first
//   NAME.proposal-IDENTITY.toml    the model
//   NAME.proposal-IDENTITY.html    the report page
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filters/model_file/model.h"
#include "filters/promise/promise.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/field/field.h"

namespace ifog {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ErrorOfMeans, averaging_s, means, before_radps, after_radps)
}  // namespace ifog

namespace ifog::tools {

// Identity and SHA-256 of a model; both "" for no model.
struct ModelName {
  std::string identity, sha256;
  bool operator==(const ModelName&) const = default;
};
[[nodiscard]] ModelName name_of(const Model& model);
// The model of a sensor; nullopt if there is no file.
struct ModelInUse {
  std::optional<Model> model;
  ModelName name;
};
[[nodiscard]] ModelInUse model_in_use(const Field& field, const SensorConfig& sensor);

// Measured or predicted gain of a model on data that it was not fitted to.
struct AxisGain {
  std::string axis;
  PromiseKept kept;
};

struct Proposal {
  std::string sensor, made;  // UTC, ISO 8601
  std::string why;           // one line
  ModelName against, model;
  std::string model_file, report_file;  // in the state folder
  std::vector<AxisGain> gain;           // on held-out data; the axes that the model changes
};

// "10 s means 0.0312 -> 0.0081 °/h", for the averaging time with the largest gain.
[[nodiscard]] std::string gain_text(const std::vector<AxisGain>& gain);

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ModelName, identity, sha256)
void to_json(nlohmann::json& json, const AxisGain& gain);
void from_json(const nlohmann::json& json, AxisGain& gain);

// Replaces an existing proposal. Files are written whole, the index last. Throws std::runtime_error with one
// line.
void write_proposal(const std::string& state, const Proposal& proposal, const Model& model,
                    const std::string& report);

// nullopt: no proposal. Throws std::runtime_error with one line if it is damaged or of another version.
[[nodiscard]] std::optional<Proposal> read_proposal(const std::string& state, const std::string& sensor);
// Reads its model and checks that it is the one in the index. Throws as above.
[[nodiscard]] Model proposed_model(const std::string& state, const Proposal& proposal);
void remove_proposal(const std::string& state, const std::string& sensor);

// Names of the sensors with a proposal.
[[nodiscard]] std::vector<std::string> sensors_with_proposal(const std::string& state);

}  // namespace ifog::tools
