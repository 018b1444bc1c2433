// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/search/unfold.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "filters/diagnosis/search/refine.h"

namespace ifog {
namespace {

// Twice the log-likelihood that each has to gain.
constexpr double kSecondLag = 16.0;
constexpr std::array<double, 2> kPowerAverages_s = {0.4, 2.5};  // that are refined
constexpr std::array<double, 2> of_lag(double lag_s) { return {0.1 * lag_s, 0.5 * lag_s}; }

double gained(const NoiseFit& with, const NoiseFit& without) {
  return 2.0 * (with.log_likelihood - without.log_likelihood);
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

}  // namespace ifog
