// SPDX-License-Identifier: Apache-2.0
#include "filters/tune/maximum.h"

#include <algorithm>
#include <cmath>
#include <nlopt.hpp>
#include <stdexcept>

#include "filters/linear/symmetric.h"
#include "filters/state_models/state_model.h"

namespace ifog {
namespace {

// Coordinates in which a unit step in any direction costs about 0.5 of log-likelihood: axes of the expected
// information in units of their standard errors, so the search is well-scaled.
class Whitened {
 public:
  Whitened(const RecordObjective& objective, const Eigen::MatrixXd& information, std::vector<double> origin)
      : objective_(objective), origin_(std::move(origin)), low_(origin_.size()), high_(origin_.size()) {
    objective_.candidate().bounds(low_, high_);
    Eigen::MatrixXd full = information;
    // Limits steps to one where the spectrum gives little information.
    full.diagonal().array() += 1.0;
    const SymmetricEigen eigen = symmetric_eigen(full);
    directions_ = eigen.vectors * eigen.values.cwiseMax(1e-12).cwiseSqrt().cwiseInverse().asDiagonal();
  }

  [[nodiscard]] std::vector<double> theta(std::span<const double> unit) const {
    const Eigen::Map<const Eigen::VectorXd> u(unit.data(), static_cast<Eigen::Index>(unit.size()));
    const Eigen::VectorXd moved = directions_ * u;
    std::vector<double> out = origin_;
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = std::clamp(out[i] + moved(static_cast<Eigen::Index>(i)), low_[i], high_[i]);
    return out;
  }
  static double call(unsigned n, const double* unit, double*, void* self) {
    const auto& whitened = *static_cast<const Whitened*>(self);
    return whitened.objective_(whitened.theta(std::span(unit, n)));
  }

 private:
  const RecordObjective& objective_;
  std::vector<double> origin_, low_, high_;
  Eigen::MatrixXd directions_;
};

}  // namespace

double RecordObjective::operator()(std::span<const double> theta) const {
  constexpr double kNone = 1e300;
  const FilterSettings s = candidate_.settings(theta, 1.0);
  std::unique_ptr<StateModel> model;
  try {
    model = make_state_model(s.state, s.state_parameters, period_s_);
  } catch (const std::invalid_argument&) {
    // An autoregression at the limit of stationarity.
    return kNone;
  }
  const double cost =
      -likelihood(*model, s.process_noise, s.measurement_noise, record_, period_s_).log_likelihood();
  return std::isfinite(cost) ? cost : kNone;
}

double find_maximum(const RecordObjective& objective, const Eigen::MatrixXd& information,
                    std::vector<double>& theta) {
  const auto n = static_cast<unsigned>(theta.size());
  double best = objective(theta);
  // Restarts at the result while that gains, because the scaling was that of the first start.
  constexpr double kGain = 0.05;
  for (int round = 0; round < 4; ++round) {
    Whitened whitened(objective, information, theta);
    nlopt::opt search(nlopt::LN_BOBYQA, n);
    search.set_min_objective(&Whitened::call, &whitened);
    search.set_initial_step(1.0);
    search.set_xtol_abs(0.01);  // standard deviations
    search.set_ftol_abs(1e-3);  // of −ln L, where 0.5 is the cost of a parameter
    search.set_maxeval(50 * static_cast<int>(n));
    std::vector<double> unit(n, 0.0);
    double cost = best;
    try {
      search.optimize(unit, cost);
    } catch (const nlopt::roundoff_limited&) {
      // unit contains the best point found
    }
    std::vector<double> moved = whitened.theta(unit);
    cost = objective(moved);
    if (!(cost < best)) break;
    const double gained = best - cost;
    best = cost;
    theta = std::move(moved);
    if (gained < kGain) break;
  }
  return best;
}

Eigen::MatrixXd covariance_at(const RecordObjective& objective, const Eigen::MatrixXd& information,
                              const std::vector<double>& theta, std::vector<bool>& known) {
  const std::size_t n = theta.size();
  std::vector<double> low(n), high(n), step(n);
  objective.candidate().bounds(low, high);
  const double at = objective(theta);
  known.assign(n, true);
  for (std::size_t i = 0; i < n; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    step[i] = 0.25 / std::sqrt(information(row, row) + 1.0);
    // A step that changes −ln L by about 0.5 is one standard error, the right distance for the curvature.
    for (int tries = 0; tries < 14; ++tries) {
      std::vector<double> moved = theta;
      moved[i] += step[i];
      if (moved[i] >= high[i] || objective(moved) - at > 0.1) break;
      step[i] *= 2.0;
    }
    if (theta[i] - step[i] <= low[i] || theta[i] + step[i] >= high[i]) known[i] = false;
  }
  std::vector<Eigen::Index> index;
  for (std::size_t i = 0; i < n; ++i)
    if (known[i]) index.push_back(static_cast<Eigen::Index>(i));
  const auto value = [&](std::size_t i, double di, std::size_t j, double dj) {
    std::vector<double> moved = theta;
    moved[i] += di * step[i];
    moved[j] += dj * step[j];
    return objective(moved);
  };
  const auto m = static_cast<Eigen::Index>(index.size());
  Eigen::MatrixXd hessian(m, m);
  for (Eigen::Index a = 0; a < m; ++a)
    for (Eigen::Index b = 0; b <= a; ++b) {
      const auto i = static_cast<std::size_t>(index[static_cast<std::size_t>(a)]),
                 j = static_cast<std::size_t>(index[static_cast<std::size_t>(b)]);
      hessian(a, b) = hessian(b, a) =
          a == b ? (value(i, 1, j, 0) - 2.0 * at + value(i, -1, j, 0)) / (step[i] * step[i])
                 : (value(i, 1, j, 1) - value(i, 1, j, -1) - value(i, -1, j, 1) + value(i, -1, j, -1)) /
                       (4.0 * step[i] * step[j]);
    }
  const auto size = static_cast<Eigen::Index>(n);
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(size, size);
  const SymmetricSolver solver(hessian);
  if (m == 0 || !solver.is_positive()) {
    known.assign(n, false);
    return full;
  }
  full(index, index) = solver.inverse();
  return full;
}

bool bound_hidden_walk(const RecordObjective& objective, std::vector<double>& theta) {
  constexpr double kAllowed = 0.5;  // of -ln L: one standard deviation
  std::vector<double> low(theta.size()), high(theta.size());
  objective.candidate().bounds(low, high);
  const auto cost = [&](double ln_q) {
    std::vector<double> other = theta;
    other[0] = ln_q;
    return objective(other);
  };
  const double none = cost(low[0]), best = std::min(none, objective(theta));
  if (none > best + kAllowed) return false;
  // Doubles from the optimum upwards, then bisects.
  double inside = theta[0], outside = inside;
  while (outside < high[0]) {
    outside = std::min(inside + 0.7, high[0]);
    if (cost(outside) > best + kAllowed) break;
    inside = outside;
  }
  constexpr double kNear = 0.02;
  while (outside - inside > kNear) {
    const double middle = 0.5 * (inside + outside);
    (cost(middle) > best + kAllowed ? outside : inside) = middle;
  }
  theta[0] = inside;
  return true;
}

}  // namespace ifog
