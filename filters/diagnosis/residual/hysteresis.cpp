// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/hysteresis.h"

#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstdint>

#include "filters/diagnosis/search/effective_tries.h"
#include "filters/linear/normal_equations.h"

namespace ifog {
namespace {

// Half widths of the play, of the channel's range.
constexpr std::array kShares = {0.05, 0.08, 0.12, 0.17, 0.22, 0.28, 0.35};
constexpr double kCertain = 0.1;  // of the significance
// Twice the log-likelihood, before the noise is fitted anew: further below the model no loop recovers.
constexpr double kHopeless = -30.0;
constexpr double kLoopParameters = 3.0;  // its size, its width, and the channel's linear effect

double log_likelihood(const Eigen::MatrixXd& gram, const std::vector<Eigen::Index>& columns, double n) {
  double square = gram(0, 0);
  if (!columns.empty())
    square -= NormalEquations(gram(columns, columns), gram(columns, {Eigen::Index{0}})).explained();
  return -0.5 * n * std::log(std::max(square, 1e-12 * gram(0, 0) + 1e-300) / n);
}

// Noise with less that is slow: the model's noise may have swallowed the loop.
std::vector<NoiseShape> quieter(const NoiseShape& shape) {
  std::vector<NoiseShape> shapes;
  for (const double walk : {1.0, 0.1, 0.01, 0.0}) {
    for (const double flicker : {1.0, 0.0}) {
      NoiseShape each = shape;
      each.walk *= walk;
      each.flicker *= flicker;
      if ((shape.walk == 0.0 && walk != 1.0) || (shape.flicker == 0.0 && flicker != 1.0)) continue;
      shapes.push_back(each);
    }
  }
  return shapes;
}

struct Best {
  double share = 0.0;
  NoiseShape shape;
  double log_likelihood = -1e300;
};

// base: measurement, constants, other effects, the channel. loops: one column a share.
Best best_share(const BlockGrid& grid, const Columns& base, const Columns& loops, const NoiseShape& noise) {
  Columns all(base.rows(), base.cols() + loops.cols());
  all << base, loops;
  Best best;
  for (const NoiseShape& shape : quieter(noise)) {
    Columns white = all;
    Whitening(grid, shape).apply(white);
    const Eigen::MatrixXd gram = white.transpose() * white;
    std::vector<Eigen::Index> columns;
    for (Eigen::Index j = 1; j <= base.cols(); ++j) columns.push_back(j);
    for (std::size_t i = 0; i < kShares.size(); ++i) {
      columns.back() = base.cols() + static_cast<Eigen::Index>(i);
      const double value = log_likelihood(gram, columns, static_cast<double>(grid.used()));
      if (value > best.log_likelihood) best = {kShares[i], shape, value};
    }
  }
  return best;
}

// Between the shares that were tried beside the best one: neighbours differ by a third, and what one explains
// less than the width itself another form gets the credit for.
double refined_width(const BlockData& data, const Columns& base, std::size_t channel, const Best& best) {
  constexpr int kBits = 8;
  const double range = data.channels[channel].high - data.channels[channel].low;
  const auto at = std::find(kShares.begin(), kShares.end(), best.share);
  const double low = at == kShares.begin() ? *at : *(at - 1);
  const double high = at + 1 == kShares.end() ? *at : *(at + 1);
  Columns columns(base.rows(), base.cols() + 1);
  columns.leftCols(base.cols()) = base;
  const auto value = [&](double share) {
    columns.rightCols(1) = hysteresis_loop(data, channel, share * range);
    return -fit_whitened(data.grid, best.shape, columns).log_likelihood;
  };
  std::uintmax_t most_evaluations = 12;
  return range * boost::math::tools::brent_find_minima(value, low, high, kBits, most_evaluations).first;
}

bool may_have_a_loop(const BlockData& data, std::size_t channel) {
  const FineChannel& c = data.channels[channel];
  return static_cast<std::ptrdiff_t>(channel) != data.reference && c.varies && c.smooth && !c.still &&
         c.environment() && names_in(c.name).less.empty();
}

}  // namespace

Eigen::VectorXd hysteresis_loop(const BlockData& data, std::size_t channel, double half_width) {
  const BlockGrid& grid = data.grid;
  const std::vector<double>& values = data.channels[channel].values;
  Eigen::VectorXd loop(static_cast<Eigen::Index>(grid.size()));
  for (const BlockRange& record : grid.records) {
    double play = values[grid.fine_steps(record).first];
    for (std::size_t b = record.first; b < record.end; ++b) {
      double sum = 0.0;
      for (std::size_t k = b * grid.fine; k < (b + 1) * grid.fine; ++k) {
        play = std::clamp(play, values[k] - half_width, values[k] + half_width);
        sum += play - values[k];
      }
      loop[static_cast<Eigen::Index>(b)] = sum / static_cast<double>(grid.fine);
    }
  }
  return loop;
}

void take_out(const Hysteresis& loop, const BlockData& data, BlockGrid& grid) {
  for (std::size_t c = 0; c < data.channels.size(); ++c) {
    if (data.channels[c].name != loop.channel) continue;
    const Eigen::VectorXd column = hysteresis_loop(data, c, loop.half_width);
    for (std::size_t b = 0; b < grid.size(); ++b) {
      const auto row = static_cast<Eigen::Index>(b);
      if (grid.valid[b]) grid.error[row] -= loop.coefficient * column[row];
    }
  }
}

std::vector<LoopFit> fit_loops(const BlockData& data, const std::vector<Candidate>& model,
                               const NoiseFit& noise) {
  std::vector<LoopFit> fits;
  for (std::size_t c = 0; c < data.channels.size() && !data.grid.dwells; ++c) {
    if (!may_have_a_loop(data, c)) continue;
    LoopFit fit;
    for (const Candidate& each : model) {
      if (each.channel != c || each.form == Form::kProduct)
        fit.beside.push_back(each);
      else
        fit.instead_of.push_back(each);
    }
    for (const Candidate& each : fit.instead_of)
      fit.saved += 1.0 + (each.searched() ? 1.0 : 0.0) +
                   (each.second_time_constant_s > 0.0 || each.is_transition() ? 1.0 : 0.0);
    fit.saved -= kLoopParameters;
    Candidate linear;
    linear.form = Form::kLinear;
    linear.channel = c;
    fit.beside.push_back(linear);
    const Columns base = design(data, fit.beside);
    const double range = data.channels[c].high - data.channels[c].low;
    Columns loops(base.rows(), static_cast<Eigen::Index>(kShares.size()));
    for (std::size_t i = 0; i < kShares.size(); ++i)
      loops.col(static_cast<Eigen::Index>(i)) = hysteresis_loop(data, c, kShares[i] * range);
    const Best best = best_share(data.grid, base, loops, noise.shape);
    if (2.0 * (best.log_likelihood - noise.log_likelihood) < kHopeless) continue;
    fit.channel = c;
    fit.loop.channel = data.channels[c].name;
    fit.loop.half_width = refined_width(data, base, c, best);
    Columns columns(base.rows(), base.cols() + 1);
    columns << base, hysteresis_loop(data, c, fit.loop.half_width);
    fit.noise = fit_noise(data.grid, columns, best.shape);
    fit.loop.likelihood_ratio = 2.0 * (fit.noise.log_likelihood - noise.log_likelihood);
    const Eigen::VectorXd coefficients = solve(data.grid, fit.noise.shape, columns);
    fit.loop.coefficient = coefficients[coefficients.size() - 1];
    fits.push_back(std::move(fit));
  }
  return fits;
}

std::optional<Hysteresis> certain_hysteresis(const BlockData& data, const std::vector<LoopFit>& fits,
                                             double significance) {
  double tries = 0.0;
  for (std::size_t c = 0; c < data.channels.size(); ++c)
    tries += may_have_a_loop(data, c) ? kProfiled * static_cast<double>(kShares.size()) : 0.0;
  std::optional<Hysteresis> found;
  const double each_parameter = std::log(static_cast<double>(data.grid.used()));
  for (const LoopFit& fit : fits) {
    const bool certain = tail(fit.loop.likelihood_ratio, 2) * tries <= kCertain * significance;
    const bool claimed = std::any_of(fit.instead_of.begin(), fit.instead_of.end(),
                                     [](const Candidate& each) { return each.form != Form::kLinear; });
    const bool plainer = claimed && fit.loop.likelihood_ratio + each_parameter * fit.saved > 0.0;
    if (!certain && !plainer) continue;
    if (!found || fit.loop.likelihood_ratio > found->likelihood_ratio) found = fit.loop;
  }
  return found;
}

}  // namespace ifog
