// SPDX-License-Identifier: Apache-2.0
// Adopted and replaced models of a sensor, oldest first: NAME.history.json in the state folder, schema
// ifog.history/1. A replaced model is kept there as NAME.kept-IDENTITY.toml.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "filters/model_file/model.h"
#include "tools/ifog/field/proposal.h"

namespace ifog::tools {

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
void to_json(nlohmann::json& json, const ModelChange& of);
void from_json(const nlohmann::json& json, ModelChange& of);

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

// The last recording that `ifog night` has processed, and its result: NAME.night.json in the state folder,
// schema ifog.night/1.
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
