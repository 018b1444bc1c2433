// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/search/refine.h"

#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstdint>
#include <utility>

#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {
namespace {

// 0.5 % of a time constant; a finer value does not change the likelihood.
constexpr int kBits = 11;
constexpr double kEdge = 0.05;  // of the range: smallest distance of a transition's centre from its edges
constexpr double kNarrowest = 0.02;  // of the range

// Sets one parameter of model[at] to its most likely value in [low, high], in its logarithm if `logarithmic`.
void set_likeliest(const BlockData& data, const NoiseShape& shape, std::vector<Candidate>& model,
                   std::size_t at, double Candidate::*which, double low, double high, bool logarithmic) {
  if (!(low < high)) {
    model[at].*which = high;
    return;
  }
  if (logarithmic) low = std::log(low), high = std::log(high);
  const auto value_of = [&](double x) { return logarithmic ? std::exp(x) : x; };
  Columns columns = design(data, model);
  const auto lacking = [&](double x) {
    Candidate trial = model[at];
    trial.*which = value_of(x);
    columns.col(column_of(data.grid, at)) = regressor(data, trial);
    return -fit_whitened(data.grid, shape, columns).log_likelihood();
  };
  std::uintmax_t most_evaluations = 30;
  model[at].*which =
      value_of(boost::math::tools::brent_find_minima(lacking, low, high, kBits, most_evaluations).first);
}

void refine_transition(const BlockData& data, const NoiseShape& shape, std::vector<Candidate>& model,
                       std::size_t at) {
  const FineChannel& channel = data.channels[model[at].channel];
  const double span = channel.high - channel.low;
  for (int round = 0; round < 3; ++round) {
    const Candidate now = model[at];
    set_likeliest(data, shape, model, at, &Candidate::centre,
                  std::max(channel.low + kEdge * span, now.centre - now.half_width),
                  std::min(channel.high - kEdge * span, now.centre + now.half_width), false);
    // Only widths with both levels visible, even if a wider one is slightly more likely.
    const double centre = model[at].centre;
    set_likeliest(data, shape, model, at, &Candidate::half_width,
                  std::max(kNarrowest * span, now.half_width / 2.0),
                  std::min({now.half_width * 2.0, centre - channel.low, channel.high - centre}), false);
  }
}

}  // namespace

void refine_shape(const BlockData& data, const NoiseShape& shape, std::vector<Candidate>& model,
                  std::size_t at) {
  if (model[at].is_transition())
    refine_transition(data, shape, model, at);
  else if (model[at].searched())
    refine(data, shape, model, at);
}

void refine(const BlockData& data, const NoiseShape& shape, std::vector<Candidate>& model, std::size_t at,
            double Candidate::*which) {
  const Form form = model[at].form;
  const std::vector<double> tried = time_constants(data.grid, form);
  // Vibration power may change as fast as the samples.
  double least = (form == Form::kBandPower ? 0.3 : 2.0) * data.grid.fine_s;
  if (form == Form::kWarmUp && !tried.empty()) least = tried.front();
  const double most = tried.empty() ? 3600.0 : std::min(3600.0, 1.6 * tried.back());
  const double now = model[at].*which;
  const double high = std::min(std::max(now * 2.5, least), most);
  set_likeliest(data, shape, model, at, which, std::min(std::max(now / 2.5, least), high), high, true);
}

namespace {

// Required gain of twice the log-likelihood of each.
constexpr double kSecondLag = 16.0;
constexpr std::array<double, 2> kPowerAverages_s = {0.4, 2.5};  // start values
constexpr std::array<double, 2> of_lag(double lag_s) { return {0.1 * lag_s, 0.5 * lag_s}; }

double gained(const NoiseFit& with, const NoiseFit& without) {
  return 2.0 * (with.log_likelihood - without.log_likelihood);
}

}  // namespace

void try_second_time_constants(const BlockData& data, FittedModel& model) {
  for (std::size_t i = 0; i < model.effects.size(); ++i) {
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
