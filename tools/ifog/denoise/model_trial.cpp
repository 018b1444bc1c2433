// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/denoise/model_trial.h"

#include <nlohmann/json.hpp>
#include <span>

#include "filters/effects/form.h"
#include "tools/ifog/console/say.h"

namespace ifog::tools {
namespace {

bool is_rate(const std::string& channel) {
  return is_reference_rate(channel) || !axis_of_rate(channel).empty();
}

}  // namespace

void ModelTrial::begin(const Model& model, const std::vector<std::string>& axes) {
  axes_ = axes;
  of_rate_.assign(axes.size(), false);
  for (const Effect& effect : model.effects)
    for (std::size_t axis = 0; axis < axes.size(); ++axis)
      if ((effect.axis.empty() || effect.axis == axes[axis]) &&
          (is_rate(effect.channel) || is_rate(effect.with_channel)))
        of_rate_[axis] = true;
  if (!model.effects.empty()) trial_.emplace(axes.size());
}

void ModelTrial::add(double time_s, const Axes& raw_radps, const Axes& compensated_radps) {
  if (trial_)
    trial_->add(time_s, std::span(raw_radps).first(axes_.size()),
                std::span(compensated_radps).first(axes_.size()));
}

void ModelTrial::weigh() {
  for (std::size_t axis = 0; trial_ && axis < axes_.size(); ++axis)
    shares_.push_back(of_rate_[axis] ? std::nullopt : trial_->weigh(axis));
}

void ModelTrial::tell(const std::string& capture) const {
  for (std::size_t axis = 0; axis < shares_.size(); ++axis) {
    if (!shares_[axis] || !shares_[axis]->denied) continue;
    const std::string of_axis = axes_[axis].empty() ? "" : "axis " + axes_[axis] + ": ";
    warn(
        "{}: {}{:.0f} ± {:.0f} % of what the model corrects is in this capture, expected 100 %: the effect "
        "only ran along with its channels when it was fitted; run ifog diagnose on both captures together\n",
        capture, of_axis, 100.0 * shares_[axis]->share, 100.0 * shares_[axis]->share_error);
  }
}

void ModelTrial::add_to(nlohmann::json& axes) const {
  for (std::size_t axis = 0; axis < shares_.size(); ++axis) {
    if (!shares_[axis]) continue;
    axes[axis]["model_share"] = shares_[axis]->share;
    axes[axis]["model_share_error"] = shares_[axis]->share_error;
  }
}

}  // namespace ifog::tools
