// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/report/loop_rivals.h"

#include <algorithm>
#include <cmath>

namespace ifog {
namespace {

// A loop has a width besides its size and is rarer than any form: twice the log-likelihood, as complexity().
constexpr double kComplexity = 8.0;

// As the noise filter sees them.
double correlation(const BlockGrid& grid, const NoiseShape& shape, const Eigen::VectorXd& a,
                   const Eigen::VectorXd& b) {
  Columns both(a.size(), 2);
  both << a, b;
  centre_records(grid, both);
  Whitening(grid, shape).apply(both);
  return both.col(0).dot(both.col(1)) / std::max(both.col(0).norm() * both.col(1).norm(), 1e-300);
}

// Sum of effects and coefficients over the blocks.
Eigen::VectorXd sum_of(const BlockData& data, const std::vector<Candidate>& candidates,
                       const std::vector<Effect>& effects) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(data.grid.size()));
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Columns columns = regressors(data, candidates[i]);
    for (Eigen::Index j = 0; j < columns.cols(); ++j)
      sum += columns.col(j) * effects[i].parameters[static_cast<std::size_t>(j)].value;
  }
  return sum;
}

}  // namespace

void add_loop_rivals(const BlockData& data, const std::vector<LoopFit>& fits, const NoiseShape& shape,
                     const std::string& axis, Findings& findings) {
  for (const LoopFit& fit : fits) {
    const auto linear = [](const Candidate& each) { return each.form == Form::kLinear; };
    if (std::all_of(fit.instead_of.begin(), fit.instead_of.end(), linear)) continue;
    double loss = kComplexity - fit.loop.likelihood_ratio;
    for (const Candidate& each : fit.instead_of) loss -= complexity(each);
    if (loss > kNoRival) continue;
    OtherExplanation other;
    const Eigen::VectorXd loop = hysteresis_loop(data, fit.channel, fit.loop.half_width);
    other.effects = fitted_effects(data, fit.beside, fit.noise.shape, axis, &loop);
    other.weight = std::exp(-0.5 * std::max(0.0, loss));
    other.hysteresis = fit.loop;

    std::vector<Candidate> model = fit.beside;
    model.pop_back();
    model.insert(model.end(), fit.instead_of.begin(), fit.instead_of.end());
    const std::vector<Effect> mine = fitted_effects(data, model, shape, axis);
    Indistinguishable pair;
    const auto nonlinear = std::find_if_not(fit.instead_of.begin(), fit.instead_of.end(), linear);
    pair.effects = {effect_of(data, *nonlinear), Effect{}};
    pair.effects[0].axis = axis;
    pair.effects[1].form = "hysteresis";
    pair.effects[1].channel = fit.loop.channel;
    pair.effects[1].axis = axis;
    pair.correlation = correlation(data.grid, shape, sum_of(data, model, mine),
                                   sum_of(data, fit.beside, other.effects) + fit.loop.coefficient * loop);
    pair.separate_by = "a capture in which " + fit.loop.channel +
                       " runs up and down between the same values, more than once";
    findings.pairs.push_back(std::move(pair));
    findings.others.push_back(std::move(other));
  }
}

}  // namespace ifog
