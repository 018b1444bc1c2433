// SPDX-License-Identifier: Apache-2.0
// Configuration, models and proposals of this computer's daemon, to complete what it publishes.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "tools/ifog/field/field.h"
#include "tools/ifog/monitor/sensor_view.h"

namespace ifog::tools {

class KnownHere {
 public:
  // A configuration that is not given is used while a daemon runs with its state folder; it may be missing or
  // unreadable. Throws as Field does for a given one.
  explicit KnownHere(const FieldOptions& options);
  // Reads models and proposals again.
  void look();
  // By the name in capitals, as in a channel's name; null: unknown.
  [[nodiscard]] const KnownSensor* of(const std::string& name) const;

 private:
  bool named_;
  std::optional<Field> field_;
  std::map<std::string, KnownSensor> sensors_;
};

}  // namespace ifog::tools
