// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/search/unfold.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "filters/diagnosis/checks/proof.h"
#include "filters/diagnosis/search/refine.h"

namespace ifog {
namespace {

// Twice the log-likelihood that each has to gain.
constexpr double kSecondLag = 16.0;
constexpr double kSecondLayer = 24.0;                           // a time constant and a coefficient
constexpr double kApart = 3.0;                                  // beyond complexity
constexpr double kOneMore = 6.0;                                // and for one effect more than there was
constexpr std::array<double, 2> kPowerAverages_s = {0.4, 2.5};  // that are refined
constexpr std::array<double, 2> of_lag(double lag_s) { return {0.1 * lag_s, 0.5 * lag_s}; }
constexpr std::array<double, 2> kLayers = {0.2, 5.0};  // of the time constant that is there
constexpr double kLayersApart = 2.0;                   // time constants, at least

double gained(const NoiseFit& with, const NoiseFit& without) {
  return 2.0 * (with.log_likelihood - without.log_likelihood);
}

// Beside the rate at `at` a second one, that begins at `start_s`. None where there are no two layers.
std::optional<FittedModel> with_layer(const BlockData& data, const FittedModel& model, std::size_t at,
                                      double start_s) {
  FittedModel trial = model;
  trial.effects.push_back(model.effects[at]);
  const std::size_t last = trial.effects.size() - 1;
  trial.effects[last].time_constant_s = start_s;
  for (int round = 0; round < 3; ++round) {
    refine(data, trial.noise.shape, trial.effects, last);
    refine(data, trial.noise.shape, trial.effects, at);
    trial.noise = fit_noise(data.grid, design(data, trial.effects), trial.noise.shape);
  }
  const auto [quick, slow] =
      std::minmax(trial.effects[at].time_constant_s, trial.effects[last].time_constant_s);
  if (slow < kLayersApart * quick) return std::nullopt;
  const Eigen::VectorXd c = solve(data.grid, trial.noise.shape, design(data, trial.effects));
  const double one = c[column_of(data.grid, trial.effects, at) - 1];
  const double other = c[column_of(data.grid, trial.effects, last) - 1];
  if (!(one * other > 0.0) || gained(trial.noise, model.noise) < kSecondLayer) return std::nullopt;
  if (!predicts_held_out(data, {trial.effects, trial.noise})) return std::nullopt;
  return trial;
}

// The two factors instead of the product at `at`; none of what is a switch's or a scale factor's.
std::optional<std::vector<Candidate>> factors_of(const BlockData& data, const std::vector<Candidate>& effects,
                                                 std::size_t at) {
  const Candidate product = effects[at];
  if (product.form != Form::kProduct || product.with_form != Form::kLinear) return std::nullopt;
  std::vector<Candidate> apart = effects;
  apart.erase(apart.begin() + static_cast<std::ptrdiff_t>(at));
  for (const std::size_t channel : {product.channel, product.with_channel}) {
    const FineChannel& source = data.channels[channel];
    if (static_cast<std::ptrdiff_t>(channel) == data.reference || source.two_valued || !source.environment())
      return std::nullopt;
    Candidate linear;
    linear.form = Form::kLinear;
    linear.channel = channel;
    const auto same = [&](const Candidate& each) { return each.same_shape(linear); };
    if (std::none_of(apart.begin(), apart.end(), same)) apart.push_back(linear);
  }
  return apart;
}

}  // namespace

void try_second_time_constants(const BlockData& data, std::size_t first, FittedModel& model) {
  for (std::size_t i = first; i < model.effects.size(); ++i) {
    const bool power = model.effects[i].form == Form::kBandPower;
    if (model.effects[i].form != Form::kLagged && !power) continue;
    const NoiseFit before = model.noise;
    for (const double start_s : power ? kPowerAverages_s : of_lag(model.effects[i].time_constant_s)) {
      std::vector<Candidate> trial = model.effects;
      trial[i].second_time_constant_s = start_s;
      for (int round = 0; round < 2; ++round) {
        refine(data, model.noise.shape, trial, i, &Candidate::second_time_constant_s);
        refine(data, model.noise.shape, trial, i);
      }
      const NoiseFit noise = fit_noise(data.grid, design(data, trial), model.noise.shape);
      if (gained(noise, before) >= kSecondLag && gained(noise, model.noise) > 0.0)
        model = {std::move(trial), noise};
    }
  }
}

void try_second_layers(const BlockData& data, std::size_t first, FittedModel& model) {
  const std::size_t found = model.effects.size();
  for (std::size_t i = first; i < found; ++i) {
    const Candidate& rate = model.effects[i];
    const auto again = [&](const Candidate& other) { return other.same_shape(rate); };
    if (rate.form != Form::kRate || std::count_if(model.effects.begin(), model.effects.end(), again) > 1)
      continue;
    std::optional<FittedModel> best;
    for (const double factor : kLayers) {
      auto trial = with_layer(data, model, i, factor * rate.time_constant_s);
      if (trial && (!best || gained(trial->noise, best->noise) > 0.0)) best = std::move(trial);
    }
    if (best) model = std::move(*best);
  }
}

void try_factors_apart(const BlockData& data, std::size_t first, FittedModel& model) {
  for (std::size_t i = first; i < model.effects.size(); ++i) {
    const auto apart = factors_of(data, model.effects, i);
    if (!apart) continue;
    const NoiseFit noise = fit_noise(data.grid, design(data, *apart), model.noise.shape);
    const double plainer = complexity(model.effects) - complexity(*apart);
    const double more = apart->size() > model.effects.size() ? kOneMore : 0.0;
    if (gained(noise, model.noise) + plainer > kApart + more) model = {*apart, noise};
  }
}

}  // namespace ifog
