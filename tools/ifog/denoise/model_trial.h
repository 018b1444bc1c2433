// SPDX-License-Identifier: Apache-2.0
// Tests if the effects that a model corrects are in the capture. A channel's effect and a hidden cause that
// is correlated with it look alike in one capture, but rarely in the next one. Then a warning is printed.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "filters/model_file/model.h"
#include "filters/promise/running_trial.h"
#include "filters/settings/axes.h"
#include "tools/ifog/denoise/moments.h"

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

// Compares the raw and the compensated rate with the reference rate of the capture, where it has one.
class ReferenceTrial {
 public:
  // The capture must outlive this; without it nothing is compared.
  void follow(const CaptureView& capture) {
    capture_ = &capture;
    axes_.resize(capture.axes.size());
  }
  void add(double time_s, const Axes& raw_radps, const Axes& compensated_radps);
  // Warns about each axis whose compensated rate is significantly farther from the reference than its raw one.
  void tell(const std::string& capture) const;

 private:
  struct OfAxis {
    Moments raw, compensated;                        // of the present second: minus the reference
    Moments raw_square, compensated_square, growth;  // of the means over 1 s; growth: of their square
  };

  const CaptureView* capture_ = nullptr;
  std::size_t row_ = 0;
  double second_ = 0.0;
  std::vector<OfAxis> axes_;
};

}  // namespace ifog::tools
