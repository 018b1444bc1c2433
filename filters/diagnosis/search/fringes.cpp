// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/search/fringes.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "filters/diagnosis/checks/cross_validation.h"
#include "filters/diagnosis/search/scan.h"
#include "filters/effects/meaning.h"
#include "filters/linear/projection.h"
#include "filters/model_file/channel_names.h"

namespace ifog {
namespace {

// Fringes within the range. Fewer are a polynomial's as well, of more a thermometer's noise leaves nothing.
constexpr double kFewestFringes = 1.25;
constexpr double kMostFringes = 12.0;
constexpr double kStepOfFringes = 0.25;  // neighbours correlate by 0.9
// Twice the log-likelihood: the period is free, and a fringe is a bolder claim than a law about a point.
constexpr double kFreePeriod = 8.0;
constexpr double kInstead = 3.0;  // and a change of what was found
constexpr int kPeriodBits = 14;

Candidate half_of(Form form, std::size_t channel, double period) {
  Candidate half;
  half.form = form;
  half.channel = channel;
  half.period = period;
  return half;
}

std::vector<Candidate> with_halves(std::vector<Candidate> effects, std::size_t channel, double period) {
  effects.push_back(half_of(Form::kCosine, channel, period));
  effects.push_back(half_of(Form::kSine, channel, period));
  return effects;
}

bool may_have_fringes(const BlockData& data, std::size_t channel) {
  const FineChannel& source = data.channels[channel];
  return kind_of(source.name) == ChannelKind::kTemperature && source.varies && !source.still &&
         source.environment() && names_in(source.name).less.empty();
}

bool is_fringe(const BlockData& data, const Candidate& each) {
  return (each.form == Form::kCosine || each.form == Form::kSine) &&
         !(data.channels[each.channel].period > 0.0);
}

// What a fringe may have been spelled by.
bool spells(const Candidate& each, std::size_t channel, bool with_linear) {
  if (each.channel != channel || each.first_reading != FirstReading::kError) return false;
  return each.form == Form::kQuadratic || each.form == Form::kCubic || each.form == Form::kTransition ||
         (with_linear && each.form == Form::kLinear);
}

// Noise that has not swallowed what is sought: with less and less that is slow.
std::vector<NoiseShape> quieter(const NoiseShape& shape) {
  std::vector<NoiseShape> shapes;
  for (const double share : {1.0, 0.1, 0.01, 0.0}) {
    shapes.push_back(shape);
    shapes.back().walk *= share;
    shapes.back().flicker *= share;
    shapes.back().markov *= share;
    if (shape.walk == 0.0 && shape.flicker == 0.0 && shape.markov == 0.0) break;
  }
  return shapes;
}

struct Found {
  double period = 0.0;
  double likelihood = -1e300;
  NoiseShape shape;
};

// Over a grid of periods: the regressors of all of them whitened together, each pair's gain by itself.
Found likeliest_on_grid(const BlockData& data, const std::vector<Candidate>& base, const NoiseShape& noise,
                        std::size_t channel) {
  const FineChannel& source = data.channels[channel];
  const double span = source.high - source.low;
  std::vector<double> periods;
  for (double k = kFewestFringes; k <= kMostFringes; k += kStepOfFringes) periods.push_back(span / k);
  const Columns fixed = design(data, base);
  Columns all(fixed.rows(), fixed.cols() + 2 * static_cast<Eigen::Index>(periods.size()));
  all.leftCols(fixed.cols()) = fixed;
  for (std::size_t i = 0; i < periods.size(); ++i)
    for (const Form form : {Form::kCosine, Form::kSine})
      all.col(fixed.cols() + 2 * static_cast<Eigen::Index>(i) + (form == Form::kSine ? 1 : 0)) =
          regressors(data, half_of(form, channel, periods[i])).col(0);
  Found best;
  const auto n = static_cast<double>(data.grid.used());
  for (const NoiseShape& shape : quieter(noise)) {
    Columns white = all;
    Whitening(data.grid, shape).apply(white);
    const Projection others(white.middleCols(1, fixed.cols() - 1));
    Eigen::VectorXd y = white.col(0);
    others.take_out_of(y);
    Columns halves = white.rightCols(all.cols() - fixed.cols());
    others.take_out_of(halves);
    const double square = y.squaredNorm();
    for (std::size_t i = 0; i < periods.size(); ++i) {
      const auto pair = halves.middleCols<2>(2 * static_cast<Eigen::Index>(i));
      const Eigen::Matrix2d gram = pair.transpose() * pair;
      const Eigen::Vector2d xy = pair.transpose() * y;
      if (gram.determinant() <= 1e-9 * gram(0, 0) * gram(1, 1)) continue;
      const double left = std::max(square - xy.dot(gram.inverse() * xy), 1e-12 * square);
      const double likelihood = -0.5 * n * std::log(left / n);
      if (likelihood > best.likelihood) best = {periods[i], likelihood, shape};
    }
  }
  return best;
}

// The period of greatest likelihood between its neighbours, by fringes within the range.
double refined_period(const BlockData& data, const std::vector<Candidate>& base, const NoiseShape& shape,
                      std::size_t channel, double period) {
  const FineChannel& source = data.channels[channel];
  const double span = source.high - source.low;
  const auto value = [&](double fringes) {
    return -fit_whitened(data.grid, shape, design(data, with_halves(base, channel, span / fringes)))
                .log_likelihood;
  };
  std::uintmax_t most_evaluations = 25;
  const double now = span / period;
  const double best =
      boost::math::tools::brent_find_minima(value, std::max(0.9, now - kStepOfFringes), now + kStepOfFringes,
                                            kPeriodBits, most_evaluations)
          .first;
  return span / best;
}

FittedModel fitted(const BlockData& data, const std::vector<Candidate>& base, const NoiseShape& start,
                   std::size_t channel) {
  const Found found = likeliest_on_grid(data, base, start, channel);
  double period = refined_period(data, base, found.shape, channel, found.period);
  NoiseFit noise = fit_noise(data.grid, design(data, with_halves(base, channel, period)), found.shape);
  period = refined_period(data, base, noise.shape, channel, period);
  std::vector<Candidate> effects = with_halves(base, channel, period);
  noise = fit_noise(data.grid, design(data, effects), noise.shape);
  return {std::move(effects), noise};
}

double score(const FittedModel& model) {
  return 2.0 * model.noise.log_likelihood - complexity(model.effects);
}

// Whether the two halves gain over the same model without them more than chance with all the periods tried.
bool is_no_chance(const BlockData& data, const FittedModel& trial, const NoiseFit& without,
                  const Significance& significance) {
  const std::vector<Candidate> halves(trial.effects.end() - 2, trial.effects.end());
  const double gain =
      2.0 * (trial.noise.log_likelihood - without.log_likelihood) - complexity(halves) - kFreePeriod;
  if (gain <= 0.0) return false;
  const double tries = significance.tries + 2.0 * (kMostFringes - kFewestFringes);
  if (kProfiled * tail(gain, 2) * tries > significance.level) return false;
  // Either half may be the smaller one.
  FittedModel turned = trial;
  std::swap(turned.effects[turned.effects.size() - 1], turned.effects[turned.effects.size() - 2]);
  return predicts_held_out(data, {trial.effects, trial.noise}) ||
         predicts_held_out(data, {turned.effects, turned.noise});
}

}  // namespace

std::optional<FittedModel> with_fringe(const BlockData& data, std::size_t first, const FittedModel& model,
                                       const Significance& significance) {
  if (data.grid.dwells) return std::nullopt;
  std::optional<FittedModel> best;
  double least = score(model) + kFreePeriod;
  for (std::size_t channel = 0; channel < data.channels.size(); ++channel) {
    if (!may_have_fringes(data, channel) ||
        std::any_of(model.effects.begin(), model.effects.end(),
                    [&](const Candidate& each) { return each.channel == channel && is_fringe(data, each); }))
      continue;
    for (const int instead : {0, 1, 2}) {  // of nothing, of what bends, and of the straight line as well
      std::vector<Candidate> base = model.effects;
      std::size_t at = 0;
      std::erase_if(base, [&](const Candidate& each) {
        return at++ >= first && instead > 0 && spells(each, channel, instead == 2);
      });
      if (instead > 0 && base.size() == model.effects.size()) continue;
      const NoiseFit without =
          instead == 0 ? model.noise : fit_noise(data.grid, design(data, base), model.noise.shape);
      FittedModel trial = fitted(data, base, without.shape, channel);
      const double gained = score(trial) - (instead > 0 ? kInstead : 0.0);
      if (gained <= least || !is_no_chance(data, trial, without, significance)) continue;
      least = gained;
      best = std::move(trial);
    }
  }
  return best;
}

}  // namespace ifog
