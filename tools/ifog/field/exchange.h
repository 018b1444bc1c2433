// SPDX-License-Identifier: Apache-2.0
// Puts a sensor's model in place of another, and sees that the daemon uses it: all of it or nothing.
#pragma once

#include <sys/types.h>

#include <memory>
#include <optional>
#include <string>

#include "tools/ifog/field/field.h"
#include "tools/ifog/field/live_status.h"
#include "tools/ifog/field/proposal.h"

namespace ifog::tools {

// Throws std::runtime_error with one line when the daemon could not run the sensor with this model: it is put
// together by the daemon's own code.
void require_that_it_fits(const Field& field, const SensorConfig& sensor, const Model& model);

class ModelExchange {
 public:
  // Looks, changes nothing. `in_use`: what the file in place holds. Throws std::runtime_error with one line:
  // the daemon runs and cannot be asked, or uses another model; the sensor gives
  // no samples, so that nobody would see whether it uses one.
  ModelExchange(const Field& field, const SensorConfig& sensor, const ModelName& in_use);

  [[nodiscard]] bool daemon_runs() const { return daemon_.has_value(); }
  [[nodiscard]] LiveStatus& live() { return *live_; }

  // Nothing in `model`: the file goes. Throws std::runtime_error with one line; what was in place is then in
  // place again.
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
