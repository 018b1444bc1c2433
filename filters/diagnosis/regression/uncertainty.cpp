// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/regression/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "filters/diagnosis/regression/design.h"

namespace ifog {
namespace {

// Noise parameters are tried logarithmically from negligible (1 % of the white noise's part in the record's
// mean) to values that leave no white noise.
constexpr double kNegligible = 0.03;
constexpr double kMostRatio = 1e6;
constexpr double kCoarse = 6.0;    // ratio in the first grid
constexpr double kFarBelow = 8.0;  // log-likelihood; smaller values are ignored
constexpr int kFineGrid = 9;       // values per parameter in the second grid
// Prior standard deviation of the logarithm of a time constant: the search's range.
constexpr double kLogRange = 2.0;
constexpr double kLogStep = 0.05;

std::vector<double> logarithmic(double low, double high, int count) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(count));
  const double step = count > 1 ? std::log(high / low) / (count - 1) : 0.0;
  for (int i = 0; i < count; ++i) values.push_back(low * std::exp(step * i));
  return values;
}

struct Tried {
  NoiseShape shape;
  WhitenedFit fit;
};

template <class Evaluate>
std::vector<Tried> try_all(const NoiseShape& base, const std::vector<double>& walks,
                           const std::vector<double>& flickers, Evaluate&& evaluate) {
  std::vector<Tried> tried;
  for (const double walk : walks) {
    for (const double flicker : flickers) {
      NoiseShape shape = base;
      shape.walk = walk;
      shape.flicker = flicker;
      tried.push_back({shape, evaluate(shape)});
    }
  }
  return tried;
}

double best_of(const std::vector<Tried>& tried) {
  double best = -1e300;
  for (const Tried& each : tried) best = std::max(best, each.fit.restricted_log_likelihood());
  return best;
}

// Range of the relevant values of one parameter, plus one grid step on either side.
std::pair<double, double> span_of(const std::vector<Tried>& tried, double NoiseShape::*parameter, double step,
                                  const std::pair<double, double>& limits) {
  const double least = best_of(tried) - kFarBelow;
  double low = 1e300;
  double high = 0.0;
  for (const Tried& each : tried) {
    if (each.fit.restricted_log_likelihood() < least) continue;
    low = std::min(low, each.shape.*parameter);
    high = std::max(high, each.shape.*parameter);
  }
  return {std::max(low / step, limits.first), std::min(high * step, limits.second)};
}

std::vector<SearchedParameter> searched_parameters(const std::vector<Candidate>& effects) {
  std::vector<SearchedParameter> found;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    if (effects[i].is_transition()) {
      found.push_back({i, &Candidate::half_width});
      found.push_back({i, &Candidate::centre});
    } else if (effects[i].searched() && !effects[i].smoothed) {
      found.push_back({i, &Candidate::time_constant_s});
    }
  }
  return found;
}

// Derivatives of the sum of the effects by the searched parameters, one column each.
Columns searched_columns(const BlockData& data, const std::vector<Candidate>& effects,
                         const std::vector<SearchedParameter>& searched,
                         const Eigen::VectorXd& coefficients) {
  Columns columns(static_cast<Eigen::Index>(data.grid.size()), static_cast<Eigen::Index>(searched.size()));
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    const SearchedParameter& each = searched[static_cast<std::size_t>(j)];
    const Candidate& effect = effects[each.effect];
    const double scale = coefficients[static_cast<Eigen::Index>(each.effect)] / (2.0 * kLogStep);
    columns.col(j) = scale * (regressor(data, each.moved(effect, kLogStep)) -
                              regressor(data, each.moved(effect, -kLogStep)));
  }
  return columns;
}

// Evaluates walks and flickers that the record allows: first a coarse grid, then finer ones, because a long
// record may leave one point of the coarse grid.
template <class Evaluate>
std::vector<Tried> try_noise(const BlockGrid& grid, const NoiseShape& best, Evaluate&& evaluate) {
  if (grid.dwells) return {Tried{best, evaluate(best)}};
  const auto n = static_cast<double>(grid.used());
  const std::pair<double, double> walks{kNegligible / (n * n), kMostRatio};
  const std::pair<double, double> flickers{kNegligible / n, kMostRatio};
  const auto coarse = [](const std::pair<double, double>& limits) {
    const int count =
        1 + static_cast<int>(std::ceil(std::log(limits.second / limits.first) / std::log(kCoarse)));
    return logarithmic(limits.first, limits.second, count);
  };
  std::vector<Tried> tried = try_all(best, coarse(walks), coarse(flickers), evaluate);
  for (const double factor : {kCoarse, 1.5}) {
    const auto walk = span_of(tried, &NoiseShape::walk, factor, walks);
    const auto flicker = span_of(tried, &NoiseShape::flicker, factor, flickers);
    tried = try_all(best, logarithmic(walk.first, walk.second, kFineGrid),
                    logarithmic(flicker.first, flicker.second, kFineGrid), evaluate);
  }
  return tried;
}

// Averages, weighted by the restricted likelihood.
void average(const BlockGrid& grid, const std::vector<Tried>& tried, JointFit& fit) {
  const double top = best_of(tried);
  std::vector<double> weights;
  for (const Tried& each : tried) weights.push_back(std::exp(each.fit.restricted_log_likelihood() - top));
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  const Eigen::Index p = tried.front().fit.coefficients().size();
  fit.values = Eigen::VectorXd::Zero(p);
  for (std::size_t i = 0; i < tried.size(); ++i) {
    const double white = tried[i].fit.white_variance();
    const NoiseShape& shape = tried[i].shape;
    weights[i] /= sum;
    fit.noise.parts.push_back(
        {weights[i], white * grid.block_s, shape.walk * white / grid.block_s, shape.flicker * white});
    fit.values += weights[i] * tried[i].fit.coefficients();
  }
  for (const double blocks : flicker_bank(grid)) fit.noise.flicker_s.push_back(blocks * grid.block_s);
  fit.covariance = Eigen::MatrixXd::Zero(p, p);
  for (std::size_t i = 0; i < tried.size(); ++i) {
    const Eigen::VectorXd away = tried[i].fit.coefficients() - fit.values;
    fit.covariance += weights[i] * (tried[i].fit.covariance() + away * away.transpose());
  }
}

}  // namespace

Candidate SearchedParameter::moved(Candidate candidate, double by) const {
  if (value == &Candidate::centre)
    candidate.centre += by * candidate.half_width;
  else
    candidate.*value *= std::exp(by);
  return candidate;
}

std::string_view SearchedParameter::name_in(const Effect& of) const {
  if (value == &Candidate::centre) return "";
  return value == &Candidate::half_width ? kHalfWidth : time_constant_name(of);
}

JointFit joint_fit(const BlockData& data, const std::vector<Candidate>& effects, const NoiseFit& best,
                   const Eigen::VectorXd* coefficients) {
  const BlockGrid& grid = data.grid;
  JointFit fit;
  if (coefficients) fit.searched = searched_parameters(effects);
  const Columns base = design(data, effects);
  Columns columns(base.rows(), base.cols() + static_cast<Eigen::Index>(fit.searched.size()));
  columns.leftCols(base.cols()) = base;
  if (coefficients)
    columns.rightCols(columns.cols() - base.cols()) =
        searched_columns(data, effects, fit.searched, *coefficients);
  const Prior prior{columns.cols() - base.cols(), best.white_variance / (kLogRange * kLogRange)};
  const auto evaluate = [&](const NoiseShape& shape) { return fit_whitened(grid, shape, columns, prior); };
  average(grid, try_noise(grid, best.shape, evaluate), fit);
  return fit;
}

}  // namespace ifog
