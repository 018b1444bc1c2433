// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "filters/diagnosis/diagnosis.h"

namespace ifog {

void add_to_model(const Diagnosis& diagnosis, const std::string& axis, Model& model) {
  std::size_t old = 0;
  for (const Effect& effect : model.effects) old += effect.parameters.size();
  std::vector<std::size_t> rows;  // of the diagnosis's covariance
  std::size_t all = 0;
  for (const FoundEffect& found : diagnosis.effects) {
    const std::size_t next = all + found.effect.parameters.size();
    if (!found.effect.shown_only) {
      model.effects.push_back(found.effect);
      model.effects.back().axis = axis;
      for (std::size_t i = all; i < next; ++i) rows.push_back(i);
    }
    all = next;
  }
  const bool named = std::ranges::any_of(
      diagnosis.effects, [](const FoundEffect& found) { return found.effect.form == "bias"; });
  const bool bias = diagnosis.bias && !named;
  const std::size_t fitted = rows.size();
  const std::size_t added = fitted + (bias ? 1 : 0);
  if (bias) {
    Effect effect;
    effect.form = "bias";
    effect.axis = axis;
    effect.parameters = {*diagnosis.bias};
    model.effects.push_back(std::move(effect));
  }
  // Axes are fitted separately, so covariances across axes are set to zero.
  std::vector<double> covariance((old + added) * (old + added), 0.0);
  for (std::size_t i = 0; i < old && model.covariance.size() == old * old; ++i) {
    for (std::size_t j = 0; j < old; ++j) covariance[i * (old + added) + j] = model.covariance[i * old + j];
  }
  if (bias) covariance.back() = diagnosis.bias->std_error * diagnosis.bias->std_error;
  // Without a joint fit the covariance is unknown.
  for (std::size_t i = 0; i < fitted && diagnosis.covariance.size() == all * all; ++i) {
    for (std::size_t j = 0; j < fitted; ++j)
      covariance[(old + i) * (old + added) + old + j] = diagnosis.covariance[rows[i] * all + rows[j]];
  }
  model.covariance = std::move(covariance);
  for (const ChannelRange& range : diagnosis.ranges) {
    const auto known = std::ranges::find_if(
        model.ranges, [&](const ChannelRange& other) { return other.channel == range.channel; });
    if (known == model.ranges.end()) {
      model.ranges.push_back(range);
    } else {
      known->low = std::min(known->low, range.low);
      known->high = std::max(known->high, range.high);
    }
  }
  model.noise[axis] = diagnosis.noise;
}

}  // namespace ifog
