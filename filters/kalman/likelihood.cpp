#include "filters/kalman/likelihood.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "filters/kalman/core.h"

namespace ifog {
namespace {

constexpr double kDiffuse = 1e9;
constexpr double kSettled = 1e-13;

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
  bool at_first = starting > 0;
  bool begun = false;

  LikelihoodTerms terms;
  if (innovations != nullptr) innovations->assign(rate.size(), std::numeric_limits<double>::quiet_NaN());
  bool frozen = false;
  double s = 0.0, root = 0.0, log_s = 0.0;
  for (std::size_t k = 0; k < rate.size(); ++k) {
    const bool missing = !std::isfinite(rate[k]);
    if (frozen && !missing) {
      core.x.col(0) = transition * core.x.col(0);
    } else if (begun) {
      core.predict(transition, driving);
    }
    begun = true;
    if (missing) {
      frozen = false;
      continue;
    }
    if (at_first) {
      core.x.col(0) = model.level() * rate[k];
      at_first = false;
    }
    const double innovation = rate[k] - core.rate(0);
    if (!frozen) {
      const double now = core.variance() + measurement_noise;
      const typename KalmanCore<n>::Vector gain = core.gain;
      core.correct(now);
      frozen = starting == 0 && std::abs(now - s) <= kSettled * now &&
               (core.gain - gain).norm() <= kSettled * core.gain.norm();
      s = now;
      root = std::sqrt(s);
      log_s = std::log(s);
    }
    core.update(0, innovation);
    if (starting > 0) {
      --starting;
      continue;
    }
    ++terms.count;
    terms.sum_log_variance += log_s;
    terms.sum_normalised += innovation * innovation / s;
    if (innovations != nullptr) (*innovations)[k] = innovation / root;
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

double log_likelihood(const StateModel& model, double process_noise, double measurement_noise,
                      std::span<const double> rate, double dt_s) {
  return likelihood(model, process_noise, measurement_noise, rate, dt_s).log_likelihood();
}

}  // namespace ifog
