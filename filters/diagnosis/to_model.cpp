// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "filters/diagnosis/diagnosis.h"

namespace ifog {

namespace {

// Bias of the model that is no effect of the diagnosis, with its covariance with each written parameter.
struct Constant {
  std::optional<ModelParameter> bias;
  std::vector<double> with;
};

// The insignificant bias relative to a reference; or what removes the mean of the corrections. rows: written
// parameters, of `all`.
Constant constant_of(const Diagnosis& diagnosis, const std::vector<std::size_t>& rows, std::size_t all) {
  Constant out{std::nullopt, std::vector<double>(rows.size(), 0.0)};
  const bool named = std::ranges::any_of(
      diagnosis.effects, [](const FoundEffect& found) { return found.effect.form == "bias"; });
  if (!named) out.bias = diagnosis.bias;
  if (out.bias || std::ranges::all_of(diagnosis.means, [](double mean) { return mean == 0.0; })) return out;
  std::vector<double> values;
  for (const FoundEffect& found : diagnosis.effects)
    for (const ModelParameter& parameter : found.effect.parameters) values.push_back(parameter.value);
  double value = 0.0, variance = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    value -= diagnosis.means[rows[i]] * values[rows[i]];
    for (std::size_t j = 0; j < rows.size() && diagnosis.covariance.size() == all * all; ++j)
      out.with[i] -= diagnosis.means[rows[j]] * diagnosis.covariance[rows[j] * all + rows[i]];
    variance -= diagnosis.means[rows[i]] * out.with[i];
  }
  out.bias = ModelParameter{"coefficient", value, std::sqrt(std::max(0.0, variance)), "rad/s"};
  return out;
}

}  // namespace

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
  // Axes are fitted separately, so covariances across axes are set to zero.
  const Constant constant = constant_of(diagnosis, rows, all);
  const std::size_t fitted = rows.size(), added = fitted + (constant.bias ? 1 : 0), size = old + added;
  std::vector<double> covariance(size * size, 0.0);
  for (std::size_t i = 0; i < old && model.covariance.size() == old * old; ++i)
    for (std::size_t j = 0; j < old; ++j) covariance[i * size + j] = model.covariance[i * old + j];
  // Without a joint fit the covariance is unknown.
  for (std::size_t i = 0; i < fitted && diagnosis.covariance.size() == all * all; ++i)
    for (std::size_t j = 0; j < fitted; ++j)
      covariance[(old + i) * size + old + j] = diagnosis.covariance[rows[i] * all + rows[j]];
  if (constant.bias) {
    Effect effect;
    effect.form = "bias";
    effect.axis = axis;
    effect.parameters = {*constant.bias};
    model.effects.push_back(std::move(effect));
    for (std::size_t i = 0; i < fitted; ++i)
      covariance[(size - 1) * size + old + i] = covariance[(old + i) * size + size - 1] = constant.with[i];
    covariance.back() = constant.bias->std_error * constant.bias->std_error;
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
