// SPDX-License-Identifier: Apache-2.0
// Whether what a model corrects is there in the capture that it is used on. One capture cannot tell a
// channel's effect from a hidden cause that ran along with it; the next one mostly can, and a warning says so.
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
  // Once, before the first sample. An axis whose correction depends on the rate is not weighed.
  void begin(const Model& model, const std::vector<std::string>& axes);
  void add(double time_s, const Axes& raw_radps, const Axes& compensated_radps);
  // Once, behind the last sample.
  void weigh();
  // A line of an axis in whose rate less than half of the correction is there, for sure.
  void tell(const std::string& capture) const;
  // model_share and its standard error, of each axis that was weighed.
  void add_to(nlohmann::json& axes) const;

 private:
  std::vector<std::string> axes_;
  std::vector<bool> of_rate_;
  std::optional<RunningTrial> trial_;
  std::vector<std::optional<ShareThere>> shares_;  // by axis
};

}  // namespace ifog::tools
