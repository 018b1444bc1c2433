// SPDX-License-Identifier: Apache-2.0
// Tests if the effects that a model corrects are in the capture. A channel's effect and a hidden cause that
// is correlated with it look alike in one capture, but rarely in the next one. Then a warning is printed.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "filters/model_file/model.h"
#include "filters/promise/running_trial.h"
#include "filters/settings/axes.h"

namespace ifog::tools {

class ModelTrial {
 public:
  // Call it once, before the first sample. Axes whose correction depends on the rate are not tested.
  void begin(const Model& model, const std::vector<std::string>& axes);
  void add(double time_s, const Axes& raw_radps, const Axes& compensated_radps);
  // Call it once, after the last sample.
  void weigh();
  // Warns about each axis in whose rate significantly less than half of the correction is found.
  void tell(const std::string& capture) const;
  // Adds model_share and its standard error for each tested axis.
  void add_to(nlohmann::json& axes) const;

 private:
  std::vector<std::string> axes_;
  std::vector<bool> of_rate_;
  std::optional<RunningTrial> trial_;
  std::vector<std::optional<ShareThere>> shares_;  // by axis
};

}  // namespace ifog::tools
