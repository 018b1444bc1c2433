// SPDX-License-Identifier: Apache-2.0
// Replaces a sensor's model and checks that the daemon uses it; on failure restores the previous one.
#pragma once

#include <sys/types.h>

#include <memory>
#include <optional>
#include <string>

#include "tools/ifog/field/field.h"
#include "tools/ifog/field/live_status.h"
#include "tools/ifog/field/proposal.h"

namespace ifog::tools {

// Throws std::runtime_error with one line if the daemon cannot run the sensor with this model. Uses the
// daemon's own code.
void require_that_it_fits(const Field& field, const SensorConfig& sensor, const Model& model);

class ModelExchange {
 public:
  // Checks only. `in_use`: the model in the file. Throws std::runtime_error with one line if the daemon runs
  // but does not answer or uses another model. Also if the sensor is not running, because the exchange could
  // not be verified.
  ModelExchange(const Field& field, const SensorConfig& sensor, const ModelName& in_use);

  [[nodiscard]] bool daemon_runs() const { return daemon_.has_value(); }
  [[nodiscard]] LiveStatus& live() { return *live_; }

  // model: nullopt removes the file. Throws std::runtime_error with one line after restoring `before`.
  void exchange(const std::optional<Model>& model, const std::optional<Model>& before);

 private:
  void put(const std::optional<Model>& model) const;
  void ask_for_reload();
  [[nodiscard]] bool takes_effect(const std::string& identity);
  [[nodiscard]] std::string why_not_in_effect() const;

  const Field& field_;
  std::string sensor_, path_;
  std::optional<pid_t> daemon_;
  std::unique_ptr<LiveStatus> live_;
};

}  // namespace ifog::tools
