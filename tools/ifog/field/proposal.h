// SPDX-License-Identifier: Apache-2.0
// A new model that was found at night and that nobody has adopted yet. Of each sensor at most one waits, in
// the state folder:
//
//   NAME.proposal.json             schema ifog.proposal/1: what it is; written last and removed first
//   NAME.proposal-IDENTITY.toml    the model
//   NAME.proposal-IDENTITY.html    the report page
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filters/model_file/model.h"
#include "filters/promise/promise.h"
#include "tools/ifog/console/listed_fields.h"
#include "tools/ifog/field/field.h"

namespace ifog::tools {

// A model as files of the state folder name it; both "" for none.
struct ModelName {
  std::string identity, sha256;
  bool operator==(const ModelName&) const = default;
};
[[nodiscard]] ModelName name_of(const Model& model);
// A sensor's model, whose file need not be there.
struct ModelInUse {
  std::optional<Model> model;
  ModelName name;
};
[[nodiscard]] ModelInUse model_in_use(const Field& field, const SensorConfig& sensor);

// What a model gained, or promises to gain, on data it was not fitted on.
struct AxisGain {
  std::string axis;
  PromiseKept kept;
};

struct Proposal {
  std::string sensor, made;  // UTC, ISO 8601
  std::string why;           // one line
  ModelName against, model;
  std::string model_file, report_file;  // in the state folder
  std::vector<AxisGain> gain;           // on held-out data; axes that it changes
};

// "10 s means 0.0312 -> 0.0081 °/h": of the averaging time that gains most.
[[nodiscard]] std::string gain_text(const std::vector<AxisGain>& gain);

template <typename Io, Is<ModelName> T>
void fields(Io& io, T& of) {
  io("identity", of.identity);
  io("sha256", of.sha256);
}
template <typename Io, Is<ErrorOfMeans> T>
void fields(Io& io, T& of) {
  io("averaging_s", of.averaging_s);
  io("means", of.means);
  io("before_radps", of.before_radps);
  io("after_radps", of.after_radps);
}
template <typename Io, Is<AxisGain> T>
void fields(Io& io, T& of) {
  io("axis", of.axis);
  io("seconds", of.kept.seconds);
  io("share", of.kept.share);
  io.or_unbounded("share_std_error", of.kept.share_error);
  io("errors", of.kept.errors);
}

// Replaces the waiting one, if any. All files are whole or none counts. Throws std::runtime_error with
// one line.
void write_proposal(const std::string& state, const Proposal& proposal, const Model& model,
                    const std::string& report);

// Nothing: none waits. Throws std::runtime_error with one line: damaged, of another version.
[[nodiscard]] std::optional<Proposal> read_proposal(const std::string& state, const std::string& sensor);
// Its model, which is what the proposal says it is. Throws as above.
[[nodiscard]] Model proposed_model(const std::string& state, const Proposal& proposal);
void remove_proposal(const std::string& state, const std::string& sensor);

// Sensors of which one waits, by name.
[[nodiscard]] std::vector<std::string> sensors_with_proposal(const std::string& state);

}  // namespace ifog::tools
