// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/denoise/model_trial.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "filters/model_file/form.h"
#include "filters/units/field_units.h"
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

void ReferenceTrial::add(double time_s, const Axes& raw_radps, const Axes& compensated_radps) {
  if (capture_ == nullptr) return;
  while (row_ < capture_->size() && capture_->time_s[row_] < time_s) ++row_;
  const bool over = std::exchange(second_, std::floor(time_s)) != second_;
  for (std::size_t i = 0; i < axes_.size() && row_ < capture_->size(); ++i) {
    const std::span<const double> references = capture_->reference_rate_radps[i];
    if (references.empty()) continue;
    OfAxis& axis = axes_[i];
    if (over && axis.raw.count() > 0.0) {
      const double raw = std::pow(axis.raw.mean(), 2), compensated = std::pow(axis.compensated.mean(), 2);
      axis.raw_square.add(raw);
      axis.compensated_square.add(compensated);
      axis.growth.add(compensated - raw);
      axis.raw = axis.compensated = {};
    }
    const double reference = references[row_], raw = raw_radps[i] - reference,
                 compensated = compensated_radps[i] - reference;
    if (!std::isfinite(raw + compensated)) continue;
    axis.raw.add(raw);
    axis.compensated.add(compensated);
  }
}

void ReferenceTrial::tell(const std::string& capture) const {
  constexpr double kFewest = 8.0;   // means of 1 s
  constexpr double kMuch = 0.05;    // of the mean square; else the bias changed as it does from day to day
  constexpr double kCertain = 3.0;  // standard errors
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const OfAxis& axis = axes_[i];
    const double n = axis.growth.count(), least = kCertain * axis.growth.deviation() / std::sqrt(n);
    if (n < kFewest || !(axis.growth.mean() > std::fmax(least, kMuch * axis.raw_square.mean()))) continue;
    warn(
        "{}: 1 s means of the corrected rate are {:.4g} deg/h (RMS) from {}_radps, those of the raw rate "
        "{:.4g}: the model does not hold here; run ifog diagnose on both captures together\n",
        capture, std::sqrt(axis.compensated_square.mean()) / kDegreePerHour,
        of_axis("reference_rate", capture_->axes[i]), std::sqrt(axis.raw_square.mean()) / kDegreePerHour);
  }
}

}  // namespace ifog::tools
