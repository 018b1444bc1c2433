// SPDX-License-Identifier: Apache-2.0
// Configuration, models and proposals of this computer's daemon, for who shows what it publishes.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "tools/ifog/field/field.h"
#include "tools/ifog/monitor/view_lines.h"

namespace ifog::tools {

class KnownHere {
 public:
  // A configuration that was not named counts while a daemon runs with its state folder, and need not be there or be readable.
  // Throws as Field does, for a named configuration.
  explicit KnownHere(const FieldOptions& options);
  // Reads models and proposals again.
  void look();
  // By the name in capitals, as in a channel's; null: nothing is known.
  [[nodiscard]] const KnownSensor* of(const std::string& name) const;

 private:
  bool named_;
  std::optional<Field> field_;
  std::map<std::string, KnownSensor> sensors_;
};

}  // namespace ifog::tools
