#include "filters/tune/tune.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlopt.hpp>
#include <stdexcept>

#include "filters/kalman/likelihood.h"
#include "filters/state_models/state_model.h"
#include "filters/tune/candidate.h"

namespace ifog {
namespace {

// A long record is fitted on its first part until the optimum is near, then on all of it.
constexpr std::size_t kFirstPart = 20000;

struct Data {
  std::vector<std::vector<double>> axes;  // scaled
  double period_s = 0.0, scale = 1.0;
  std::size_t samples = 0;
};

Data scaled(std::span<const std::span<const double>> axes, double period_s) {
  Data data;
  data.period_s = period_s;
  double sum = 0.0;
  std::size_t n = 0;
  for (const auto& axis : axes)
    for (std::size_t k = 1; k < axis.size(); ++k) {
      const double d = axis[k] - axis[k - 1];
      if (!std::isfinite(d)) continue;
      sum += d * d;
      ++n;
    }
  if (n < 200) throw std::invalid_argument(std::to_string(n) + " usable samples, expected at least 200");
  if (sum <= 0.0) throw std::invalid_argument("every sample has the same value, expected a sensor's noise");
  data.scale = std::sqrt(sum / static_cast<double>(n));
  for (const auto& axis : axes) {
    // The level is in the model; taking the first value off only keeps digits.
    double level = 0.0;
    for (const double v : axis)
      if (std::isfinite(v)) {
        level = v;
        break;
      }
    auto& copy = data.axes.emplace_back();
    for (const double v : axis) copy.push_back((v - level) / data.scale);
    for (const double v : copy) data.samples += std::isfinite(v) ? 1U : 0U;
  }
  return data;
}

class Objective {
 public:
  Objective(const Candidate& candidate, const Data& data) : candidate_(candidate), data_(data) {}
  void use_first(std::size_t samples) { first_ = samples; }

  // −ln L of the scaled data.
  [[nodiscard]] double operator()(std::span<const double> theta) const {
    const FilterSettings s = candidate_.settings(theta, 1.0);
    const auto model = make_state_model(s.state, s.state_parameters, data_.period_s);
    double sum = 0.0;
    for (const auto& axis : data_.axes) {
      const std::span<const double> part(axis.data(), std::min(first_, axis.size()));
      sum -= likelihood(*model, s.process_noise, s.measurement_noise, part, data_.period_s).log_likelihood();
    }
    // The optimiser needs a number where the filter has none.
    return std::isfinite(sum) ? sum : 1e300;
  }

  static double call(unsigned n, const double* theta, double*, void* self) {
    return (*static_cast<const Objective*>(self))(std::span<const double>(theta, n));
  }

 private:
  const Candidate& candidate_;
  const Data& data_;
  std::size_t first_ = std::numeric_limits<std::size_t>::max();
};

void minimise(Objective& objective, const Candidate& candidate, std::vector<double>& theta, double reach) {
  const auto n = static_cast<unsigned>(candidate.size());
  std::vector<double> low(n), high(n);
  candidate.bounds(low, high);
  for (unsigned i = 0; i < n; ++i) theta[i] = std::clamp(theta[i], low[i], high[i]);
  nlopt::opt search(nlopt::LN_BOBYQA, n);
  search.set_lower_bounds(low);
  search.set_upper_bounds(high);
  search.set_min_objective(&Objective::call, &objective);
  search.set_initial_step(reach);
  search.set_xtol_abs(1e-4);  // parameters are logarithms or atanh of what they mean
  search.set_ftol_abs(1e-4);  // of −ln L: far below the half unit that a parameter is worth
  search.set_maxeval(60 * static_cast<int>(n));
  double best = 0.0;
  try {
    search.optimize(theta, best);
  } catch (const nlopt::roundoff_limited&) {
    // theta holds the best point found.
  }
}

// Inverse of the curvature of −ln L; rows of parameters at a bound, or along which the data do not tell, are
// left out.
Eigen::MatrixXd covariance(const Objective& objective, const Candidate& candidate, std::vector<double> theta,
                           std::vector<bool>& known) {
  const int n = candidate.size();
  std::vector<double> low(static_cast<std::size_t>(n)), high(low);
  candidate.bounds(low, high);
  const double at = objective(theta);
  // A step that changes −ln L by about one half is of the size of the standard error, where the curvature is
  // wanted.
  std::vector<double> step(static_cast<std::size_t>(n), 1e-3);
  known.assign(static_cast<std::size_t>(n), true);
  for (std::size_t i = 0; i < step.size(); ++i) {
    for (int tries = 0; tries < 14; ++tries) {
      std::vector<double> moved = theta;
      moved[i] += step[i];
      if (objective(moved) - at > 0.1) break;
      step[i] *= 2.0;
    }
    if (theta[i] - step[i] <= low[i] || theta[i] + step[i] >= high[i]) known[i] = false;
  }
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < step.size(); ++i)
    if (known[i]) index.push_back(i);
  const auto m = static_cast<Eigen::Index>(index.size());
  const auto value = [&](std::size_t i, double di, std::size_t j, double dj) {
    std::vector<double> moved = theta;
    moved[i] += di * step[i];
    moved[j] += dj * step[j];
    return objective(moved);
  };
  Eigen::MatrixXd hessian(m, m);
  for (Eigen::Index a = 0; a < m; ++a)
    for (Eigen::Index b = 0; b <= a; ++b) {
      const std::size_t i = index[static_cast<std::size_t>(a)], j = index[static_cast<std::size_t>(b)];
      const double h =
          a == b ? (value(i, 1, j, 0) - 2.0 * at + value(i, -1, j, 0)) / (step[i] * step[i])
                 : (value(i, 1, j, 1) - value(i, 1, j, -1) - value(i, -1, j, 1) + value(i, -1, j, -1)) /
                       (4.0 * step[i] * step[j]);
      hessian(a, b) = hessian(b, a) = h;
    }
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(n, n);
  const Eigen::LDLT<Eigen::MatrixXd> solver(hessian);
  if (m == 0 || !solver.isPositive()) {
    known.assign(known.size(), false);
    return full;
  }
  const Eigen::MatrixXd inverse = solver.solve(Eigen::MatrixXd::Identity(m, m));
  for (Eigen::Index a = 0; a < m; ++a)
    for (Eigen::Index b = 0; b < m; ++b)
      full(static_cast<Eigen::Index>(index[static_cast<std::size_t>(a)]),
           static_cast<Eigen::Index>(index[static_cast<std::size_t>(b)])) = inverse(a, b);
  return full;
}

// Errors of the reported figures: their gradient with respect to theta through its covariance.
std::vector<TunedFigure> figures_with_errors(const Candidate& candidate, const std::vector<double>& theta,
                                             double scale, const Eigen::MatrixXd& covariance,
                                             const std::vector<bool>& known) {
  const auto base = candidate.figures(theta, scale);
  std::vector<std::vector<CandidateFigure>> moved;
  constexpr double kStep = 1e-6;
  for (std::size_t i = 0; i < theta.size(); ++i) {
    std::vector<double> other = theta;
    other[i] += kStep;
    moved.push_back(candidate.figures(other, scale));
  }
  std::vector<TunedFigure> out;
  for (std::size_t f = 0; f < base.size(); ++f) {
    Eigen::VectorXd gradient(static_cast<Eigen::Index>(theta.size()));
    bool told = true;
    for (std::size_t i = 0; i < theta.size(); ++i) {
      const double slope = (moved[i][f].value - base[f].value) / kStep;
      gradient(static_cast<Eigen::Index>(i)) = slope;
      if (slope != 0.0 && !known[i]) told = false;
    }
    TunedFigure figure{base[f].name, base[f].unit, base[f].value, std::nullopt};
    if (told) figure.std_error = std::sqrt(std::max(0.0, gradient.dot(covariance * gradient)));
    out.push_back(std::move(figure));
  }
  return out;
}

}  // namespace

Tuning tune(std::span<const std::span<const double>> axes, double period_s, const TuneOptions& options) {
  const Data data = scaled(axes, period_s);
  const std::vector<std::string> states = options.states.empty() ? default_candidates() : options.states;
  Tuning result;
  result.samples = data.samples;
  for (const std::string& state : states) {
    const auto candidate = make_candidate(state, period_s);
    Objective objective(*candidate, data);
    std::vector<double> theta(static_cast<std::size_t>(candidate->size()));
    candidate->start(theta);
    objective.use_first(kFirstPart);
    minimise(objective, *candidate, theta, 1.0);
    objective.use_first(std::numeric_limits<std::size_t>::max());
    minimise(objective, *candidate, theta, 0.3);

    TunedModel model;
    model.settings = candidate->settings(theta, data.scale);
    model.parameters = candidate->size();
    // Back to the density of the data in rad/s, so that likelihoods can be set beside those of other
    // programs.
    model.log_likelihood = -objective(theta) - static_cast<double>(data.samples) * std::log(data.scale);
    model.bic = model.parameters * std::log(static_cast<double>(data.samples)) - 2.0 * model.log_likelihood;
    std::vector<bool> known;
    const Eigen::MatrixXd errors = covariance(objective, *candidate, theta, known);
    model.figures = figures_with_errors(*candidate, theta, data.scale, errors, known);
    result.models.push_back(std::move(model));
    if (options.progress) options.progress(result.models.size(), states.size());
  }
  std::stable_sort(result.models.begin(), result.models.end(),
                   [](const TunedModel& a, const TunedModel& b) { return a.bic < b.bic; });
  return result;
}

}  // namespace ifog
