// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/fleet/gather.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "filters/model_file/covariance.h"
#include "filters/model_file/form.h"
#include "filters/population/shrinkage.h"

namespace ifog::tools {
namespace {

EffectInGyro* gyro_of(TypeEffect& effect, std::size_t gyro) {
  for (EffectInGyro& each : effect.gyros)
    if (each.gyro == gyro) return &each;
  return nullptr;
}

struct Fitted {
  std::vector<Effect> effects;  // the effects of one axis for the model
  std::vector<Eigen::Index> at;
  JointEstimate estimate;
};

Fitted fit_with_prior(const AxisMeasured& axis, std::size_t gyro, std::vector<TypeEffect>& type) {
  Fitted fitted;
  std::vector<Effect> all;
  std::vector<KnownCoefficient> known;
  std::vector<EffectInGyro*> of_type;
  for (std::size_t i = 0; i < axis.together.size(); ++i) {
    if (!axis.together[i].not_measured.empty()) continue;
    EffectInGyro* const here = gyro_of(type[axis.together[i].of_type], gyro);
    const bool found = here != nullptr && here->found;
    known.push_back({static_cast<Eigen::Index>(all.size()), found, here ? here->others : TypePrior{}});
    of_type.push_back(found ? here : nullptr);
    all.push_back(axis.together[i].effect);
  }
  all.insert(all.end(), axis.beside.begin(), axis.beside.end());
  const auto size = static_cast<Eigen::Index>(all.size());
  JointEstimate own{Eigen::VectorXd(size), Eigen::MatrixXd(size, size)};
  for (Eigen::Index i = 0; i < size; ++i) {
    own.values[i] = all[static_cast<std::size_t>(i)].parameters.front().value;
    for (Eigen::Index j = 0; j < size; ++j)
      own.covariance(i, j) = axis.covariance.at(static_cast<std::size_t>(i * size + j));
  }
  fitted.estimate = shrunk_together(own, known);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (i < of_type.size() && of_type[i] == nullptr) continue;
    ModelParameter& coefficient = all[i].parameters.front();
    coefficient.value = fitted.estimate.values[row];
    coefficient.std_error = std::sqrt(std::max(fitted.estimate.covariance(row, row), 0.0));
    if (i < of_type.size()) of_type[i]->with_prior = Estimate{coefficient.value, coefficient.std_error};
    fitted.effects.push_back(all[i]);
    fitted.at.push_back(row);
  }
  return fitted;
}

bool alike(const Effect& a, const Effect& b) {
  return a.form == b.form && a.channel == b.channel && a.with_form == b.with_form &&
         a.with_channel == b.with_channel && a.period == b.period;
}

// Mean of the rate that the own coefficients correct and the new ones do not.
double mean_moved(const Fitted& fitted, const AxisMeasured& axis, const std::vector<Effect>& own) {
  double moved = 0.0;
  for (std::size_t i = 0; i < fitted.effects.size(); ++i) {
    double corrected = -fitted.effects[i].parameters.front().value;
    for (const Effect& effect : own)
      if (effect.axis == axis.axis && alike(effect, fitted.effects[i]))
        corrected += effect.parameters.front().value;
    moved += corrected * axis.means.at(static_cast<std::size_t>(fitted.at[i]));
  }
  return moved;
}

// True if the effect was in the fit, even if the model does not contain it: of the type, or another one
// fitted with them.
bool was_fitted(const TypeToMeasure& type, const AxisMeasured& axis, const Effect& effect) {
  if (std::ranges::any_of(axis.beside, [&](const Effect& other) { return alike(other, effect); }))
    return true;
  for (std::size_t i = 0; i < axis.together.size(); ++i)
    if (axis.together[i].not_measured.empty() && is_of(type.effects[axis.together[i].of_type], effect))
      return true;
  return false;
}

// Covariance of all parameters of a model that begins with these effects: from the joint fit where available,
// otherwise from the effects' own errors.
std::vector<double> covariance_of(const std::vector<Fitted>& axes, const std::vector<Effect>& effects) {
  std::vector<double> all = of_all_parameters({}, effects);
  std::vector<std::size_t> first;  // index of the first parameter of each effect
  first.reserve(effects.size());
  std::size_t n = 0;
  for (const Effect& effect : effects) first.push_back(std::exchange(n, n + effect.parameters.size()));
  std::size_t begin = 0;  // index of the effect
  for (const Fitted& fitted : axes) {
    for (std::size_t i = 0; i < fitted.effects.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const std::size_t a = first[begin + i], b = first[begin + j];
        if (all[a * n + a] > 0.0 && all[b * n + b] > 0.0)
          all[a * n + b] = all[b * n + a] = fitted.estimate.covariance(fitted.at[i], fitted.at[j]);
      }
    begin += fitted.effects.size();
  }
  return all;
}

}  // namespace

Model model_with_prior(const Model& own, const TypeToMeasure& type, const GyroMeasured& measured,
                       std::size_t gyro, std::vector<TypeEffect>& effects) {
  Model model = own;
  model.effects.clear();
  std::vector<Fitted> together;
  for (const AxisMeasured& axis : measured.axes) {
    const Fitted& fitted = together.emplace_back(fit_with_prior(axis, gyro, effects));
    model.effects.insert(model.effects.end(), fitted.effects.begin(), fitted.effects.end());
    for (const ChannelRange& range : axis.ranges)
      if (std::ranges::find(model.ranges, range.channel, &ChannelRange::channel) == model.ranges.end())
        model.ranges.push_back(range);
  }
  for (const Effect& effect : own.effects) {
    const bool fitted = std::ranges::any_of(measured.axes, [&](const AxisMeasured& axis) {
      return axis.axis == effect.axis && was_fitted(type, axis, effect);
    });
    if (!fitted) model.effects.push_back(effect);
  }
  for (Effect& effect : model.effects)
    for (std::size_t a = 0; effect.form == "bias" && a < together.size(); ++a)
      if (measured.axes[a].axis == effect.axis)
        effect.parameters.front().value += mean_moved(together[a], measured.axes[a], own.effects);
  model.covariance = covariance_of(together, model.effects);
  // These figures belong to the model of the gyro's own diagnosis.
  model.source.before.clear();
  model.source.after.clear();
  return model;
}

}  // namespace ifog::tools
