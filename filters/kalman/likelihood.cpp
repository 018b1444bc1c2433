#include "filters/kalman/likelihood.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "filters/kalman/core.h"

namespace ifog {
namespace {

constexpr double kDiffuse = 1e9;

template <int n>
LikelihoodTerms sized(const StateModel& model, double process_noise, double measurement_noise,
                      std::span<const double> rate, double dt_s, std::vector<double>* innovations) {
  KalmanCore<n> core;
  core.h = model.measurement();
  typename KalmanCore<n>::Matrix transition, driving;
  model.discretise(dt_s, transition, driving);
  driving *= process_noise;
  const Eigen::VectorXd diffuse = model.diffuse();
  core.p = process_noise * model.stationary();
  const double noise = measurement_noise + core.variance() + core.h.dot(driving * core.h);
  core.p.diagonal() += kDiffuse * noise * diffuse;
  long starting = (diffuse.array() > 0).count();
  const bool at_first = starting > 0;
  bool begun = false;
  // Over an unbroken stretch the covariance comes to rest; from there on only the state moves, at a fraction
  // of the cost. At this tolerance the sum differs from the full recursion by less than it rounds to.
  constexpr double kAtRest = 1e-13;
  bool frozen = false;
  double frozen_s = 0.0, frozen_log = 0.0;

  LikelihoodTerms terms;
  if (innovations != nullptr) innovations->assign(rate.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < rate.size(); ++k) {
    if (frozen && std::isfinite(rate[k])) {
      core.x.col(0) = transition * core.x.col(0);
      const double innovation = rate[k] - core.rate(0);
      ++terms.count;
      terms.sum_log_variance += frozen_log;
      terms.sum_normalised += innovation * innovation / frozen_s;
      if (innovations != nullptr) (*innovations)[k] = innovation / std::sqrt(frozen_s);
      core.update(0, innovation);
      continue;
    }
    frozen = false;
    if (begun) core.predict(transition, driving);
    begun = true;
    if (!std::isfinite(rate[k])) continue;
    if (at_first && starting > 0 && terms.count == 0 && core.x.col(0).isZero())
      core.x.col(0) = model.level() * rate[k];
    const double s = core.variance() + measurement_noise;
    const double innovation = rate[k] - core.rate(0);
    if (starting > 0) {
      --starting;
    } else {
      ++terms.count;
      terms.sum_log_variance += std::log(s);
      terms.sum_normalised += innovation * innovation / s;
      if (innovations != nullptr) (*innovations)[k] = innovation / std::sqrt(s);
    }
    const typename KalmanCore<n>::Vector last_gain = core.gain;
    core.correct(s);
    core.update(0, innovation);
    frozen = starting == 0 && k > 0 && std::isfinite(rate[k - 1]) &&
             (core.gain - last_gain).cwiseAbs().maxCoeff() <= kAtRest * core.gain.cwiseAbs().maxCoeff();
    if (frozen) {
      frozen_s = s;
      frozen_log = std::log(s);
    }
  }
  return terms;
}

}  // namespace

double LikelihoodTerms::log_likelihood() const {
  return -0.5 *
         (static_cast<double>(count) * std::log(2 * std::numbers::pi) + sum_log_variance + sum_normalised);
}

double LikelihoodTerms::concentrated_log_likelihood() const {
  const auto m = static_cast<double>(count);
  return -0.5 *
         (m * std::log(2 * std::numbers::pi) + sum_log_variance + m * std::log(sum_normalised / m) + m);
}

LikelihoodTerms likelihood(const StateModel& model, double process_noise, double measurement_noise,
                           std::span<const double> rate, double dt_s, std::vector<double>* innovations) {
  constexpr std::array kSized{sized<1>, sized<2>, sized<3>, sized<4>, sized<5>, sized<6>, sized<7>, sized<8>};
  return kSized.at(static_cast<std::size_t>(model.states() - 1))(model, process_noise, measurement_noise,
                                                                 rate, dt_s, innovations);
}

}  // namespace ifog
