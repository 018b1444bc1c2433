// SPDX-License-Identifier: Apache-2.0
// What was adopted for a sensor and what it took the place of, oldest first: NAME.history.json in the state
// folder, schema ifog.history/1. A model that was replaced is kept in the same folder as NAME.kept-IDENTITY.toml.
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
  ModelName model, replaced;   // in use from then on, and before
  std::string why;             // of the proposal
  std::vector<AxisGain> gain;  // promised
  std::string outcome;         // in words, "" while nothing is known
  // Number of the last recording that was there then, 0 for none: what is newer was made afterwards, whatever
  // the wall clock did. Nothing: they could not be seen, or an older program wrote it.
  std::optional<std::uint64_t> recorded{};
};

class History {
 public:
  // Throws std::runtime_error with one line: damaged.
  History(const std::string& state, const std::string& sensor);

  [[nodiscard]] const std::vector<ModelChange>& changes() const { return changes_; }
  // The adoption that is in force, which a revert takes back; null: none is.
  [[nodiscard]] const ModelChange* in_force() const;

  // Both write the file, whole. `replaced` is kept first.
  void add(ModelChange change, const std::optional<Model>& replaced);
  // Sets the outcome of the last change.
  void set_outcome(const std::string& outcome);
  // The last change did not come about.
  void take_back();
  // A change that was written down and never made, as the model before it is in use: an adoption or a
  // revert that was killed between the two. Taken back.
  void forget_what_never_was(const ModelName& in_use);

  // Nothing where the name is that of no model. Throws as above: not there, another one.
  [[nodiscard]] std::optional<Model> kept(const ModelName& name) const;

 private:
  void write() const;
  [[nodiscard]] std::string path() const;
  [[nodiscard]] std::string kept_path(const ModelName& name) const;

  std::string state_, sensor_;
  std::vector<ModelChange> changes_;
};

}  // namespace ifog::tools
