// SPDX-License-Identifier: Apache-2.0
// Models of a sensor in the state folder, besides the one in use:
//
//   NAME.proposal.json             schema ifog.proposal/1: a model that `ifog night` found and that is not adopted
//                                  yet, at most one per sensor; written last and removed first
//   NAME.proposal-IDENTITY.toml    the model
//   NAME.proposal-IDENTITY.html    the report page
//   NAME.history.json              schema ifog.history/1: adopted and replaced models, oldest first
//   NAME.kept-IDENTITY.toml        a replaced model
//   NAME.night.json                schema ifog.night/1: what `ifog night` has processed
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "filters/model_file/model.h"
#include "filters/promise/promise.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/field/field.h"

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

// The worst verdict of the axes.
[[nodiscard]] PromiseVerdict verdict_of(const std::vector<AxisGain>& gain);
// "the promise came true: …". why_not: reason why there is no gain.
[[nodiscard]] std::string outcome(const std::vector<AxisGain>& gain, const std::string& why_not = "");
void to_json(nlohmann::json& json, const AxisGain& gain);

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

struct ModelChange {
  std::string what;            // "adopt" or "revert"
  std::string when;            // UTC
  ModelName model, replaced;   // in use afterwards, and before
  std::string why;             // from the proposal
  std::vector<AxisGain> gain;  // predicted
  std::string outcome;         // text, "" if unknown
  // Number of the last recording at that time, 0: none. Newer recordings have higher numbers even if the wall
  // clock was set. nullopt: not readable, or written by an older version.
  std::optional<std::uint64_t> recorded{};
};

class History {
 public:
  // Throws std::runtime_error with one line if the file is damaged.
  History(const std::string& state, const std::string& sensor);

  [[nodiscard]] const std::vector<ModelChange>& changes() const { return changes_; }
  // The adoption that is in use and that a revert undoes; null: none.
  [[nodiscard]] const ModelChange* in_force() const;

  // Both write the whole file. `replaced` is stored first.
  void add(ModelChange change, const std::optional<Model>& replaced);
  // Sets the outcome of the last change.
  void set_outcome(const std::string& outcome);
  // Removes the last change because it failed.
  void take_back();
  // Removes the last change if the model before it is in use: the command was killed between writing the
  // history and exchanging the model.
  void drop_incomplete_change(const ModelName& in_use);

  // nullopt if `name` is "". Throws as above if the file is missing or another model.
  [[nodiscard]] std::optional<Model> kept(const ModelName& name) const;

 private:
  void write() const;
  [[nodiscard]] std::string path() const;
  [[nodiscard]] std::string kept_path(const ModelName& name) const;

  std::string state_, sensor_;
  std::vector<ModelChange> changes_;
};

// The last recording that `ifog night` has processed, and its result.
struct Bookmark {
  std::string sensor;
  std::uint64_t until = 0;  // number of the last processed recording
  std::string when;         // UTC
  std::string said;         // one line
};

// nullopt before the first night. Throws std::runtime_error with one line if the file is damaged.
[[nodiscard]] std::optional<Bookmark> read_bookmark(const std::string& state, const std::string& sensor);
void write_bookmark(const std::string& state, const Bookmark& bookmark);

}  // namespace ifog::tools
