// SPDX-License-Identifier: Apache-2.0
#include "filters/tune/whittle.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "filters/linear/symmetric.h"

namespace ifog {
namespace {

class Objective {
 public:
  Objective(const ModelCandidate& candidate, const RecordSpectrum& spectrum)
      : candidate_(candidate), spectrum_(spectrum), density_(spectrum.bins()), moved_(spectrum.bins()) {}

  double cost(const std::vector<double>& theta) {
    candidate_.density(theta, spectrum_, density_);
    double sum = 0.0;
    for (std::size_t b = 0; b < density_.size(); ++b)
      sum += spectrum_.ordinates[b] * (std::log(density_[b]) + spectrum_.density[b] / density_[b]);
    return std::isfinite(sum) ? 0.5 * sum : 1e300;
  }

  // Gradient and expected Hessian at theta; leaves the density of cost() in place.
  void local(const std::vector<double>& theta, Eigen::VectorXd& gradient, Eigen::MatrixXd& information) {
    constexpr double kStep = 1e-6;
    candidate_.density(theta, spectrum_, density_);
    const auto columns = [](const std::vector<double>& v) {
      return Eigen::Map<const Eigen::ArrayXd>(v.data(), std::ssize(v));
    };
    const auto density = columns(density_);
    Eigen::MatrixXd slope(density.size(), std::ssize(theta));
    for (std::size_t i = 0; i < theta.size(); ++i) {
      std::vector<double> other = theta;
      other[i] += kStep;
      candidate_.density(other, spectrum_, moved_);
      slope.col(static_cast<Eigen::Index>(i)) = (columns(moved_) - density) / (density * kStep);
    }
    const Eigen::VectorXd weight = 0.5 * columns(spectrum_.ordinates);
    const Eigen::VectorXd misfit = weight.array() * (1.0 - columns(spectrum_.density) / density);
    gradient = slope.transpose() * misfit;
    information = slope.transpose() * weight.asDiagonal() * slope;
  }

 private:
  const ModelCandidate& candidate_;
  const RecordSpectrum& spectrum_;
  std::vector<double> density_, moved_;
};

// Fisher scoring with Marquardt damping; the expected Hessian is that of a nonlinear regression of the
// spectrum.
void descend(Objective& objective, const ModelCandidate& candidate, WhittleOptimum& at) {
  constexpr int kMostSteps = 60;
  constexpr double kEnough = 1e-3;  // of −ln L
  constexpr double kLongest = 2.0;  // largest step in a logarithm
  const auto n = static_cast<Eigen::Index>(at.theta.size());
  std::vector<double> low(at.theta.size()), high(low);
  candidate.bounds(low, high);
  Eigen::VectorXd gradient;
  Eigen::MatrixXd information;
  double damping = 1e-2;
  int small = 0;
  for (int step = 0; step < kMostSteps && small < 3 && damping < 1e8; ++step) {
    objective.local(at.theta, gradient, information);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto p = static_cast<std::size_t>(i);
      // parameters at a bound are fixed
      const bool held =
          (at.theta[p] <= low[p] && gradient(i) > 0.0) || (at.theta[p] >= high[p] && gradient(i) < 0.0);
      if (!held) continue;
      information.row(i).setZero();
      information.col(i).setZero();
      gradient(i) = 0.0;
    }
    double gained = -1.0;
    for (; gained < 0.0 && damping < 1e8; damping *= 8.0) {
      Eigen::MatrixXd damped = information;
      damped.diagonal() += damping * information.diagonal();
      damped.diagonal().array() += 1e-6;
      const Eigen::VectorXd move = SymmetricSolver(damped).solve(-gradient);
      WhittleOptimum next = at;
      for (Eigen::Index i = 0; i < n; ++i) {
        const auto p = static_cast<std::size_t>(i);
        next.theta[p] = std::clamp(at.theta[p] + std::clamp(move(i), -kLongest, kLongest), low[p], high[p]);
      }
      next.cost = objective.cost(next.theta);
      gained = at.cost - next.cost;
      if (gained >= 0.0) {
        at = next;
        damping /= 40.0;
      }
    }
    small = gained >= 0.0 && gained < kEnough ? small + 1 : 0;
  }
}

}  // namespace

std::vector<WhittleOptimum> whittle_optima(const ModelCandidate& candidate, const RecordSpectrum& spectrum,
                                           std::size_t draws) {
  constexpr double kSame = 0.1;
  Objective objective(candidate, spectrum);
  std::mt19937_64 random(1);
  std::vector<WhittleOptimum> starts;
  for (std::size_t i = 0; i < draws; ++i) {
    WhittleOptimum start{candidate.draw(spectrum, random), 0.0};
    start.cost = objective.cost(start.theta);
    starts.push_back(std::move(start));
  }
  std::ranges::sort(starts, {}, &WhittleOptimum::cost);
  starts.resize(std::max<std::size_t>(1, draws / 3));
  for (WhittleOptimum& start : starts) descend(objective, candidate, start);
  std::ranges::sort(starts, {}, &WhittleOptimum::cost);
  std::vector<WhittleOptimum> distinct;
  for (WhittleOptimum& start : starts)
    if (distinct.empty() || start.cost > distinct.back().cost + kSame) distinct.push_back(std::move(start));
  return distinct;
}

Eigen::MatrixXd whittle_information(const ModelCandidate& candidate, const RecordSpectrum& spectrum,
                                    const std::vector<double>& theta) {
  Objective objective(candidate, spectrum);
  Eigen::VectorXd gradient;
  Eigen::MatrixXd information;
  objective.local(theta, gradient, information);
  return information;
}

}  // namespace ifog
