// State model, Kalman core and rule put together: the filter at rest. One core for most rules; for a rule
// with several hypotheses about the noise, one core each and their weighted mean.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>

#include "filters/estimator/engine.h"
#include "filters/kalman/core.h"

namespace ifog {

template <int n>
class RestFilter {
 public:
  using Core = KalmanCore<n>;
  using Axes = std::array<double, kMaxAxes>;

  RestFilter(std::unique_ptr<StateModel> model, std::unique_ptr<Rule> rule, double process_noise,
             double measurement_noise)
      : model_(std::move(model)),
        rule_(std::move(rule)),
        hypotheses_(rule_->hypotheses()),
        process_noise_(process_noise),
        measurement_noise_(measurement_noise) {
    level_ = model_->level();
    for (Core& core : cores_) core.h = model_->measurement();
    restart();
  }

  void restart() noexcept {
    for (Core& core : cores_) {
      core.x.setZero();
      core.p = process_noise_ * model_->stationary();
      core.p.diagonal() += kDiffuse * measurement_noise_ * model_->diffuse();
    }
    rule_->restart();
  }

  void predict(double dt_s) noexcept {
    if (dt_s != discretised_dt_s_) {
      discretised_dt_s_ = dt_s;
      model_->discretise(dt_s, transition_, driving_);
      driving_ *= process_noise_;
    }
    for (std::size_t j = 0; j < hypotheses_.size(); ++j) {
      if (hypotheses_[j] == 1.0) {
        cores_[j].predict(transition_, driving_);
      } else {
        cores_[j].predict(transition_, hypotheses_[j] * driving_);
      }
    }
  }

  [[nodiscard]] double rate(int axis) const noexcept {
    if (hypotheses_.size() == 1) return cores_[0].rate(axis);
    double mean = 0.0;
    for (std::size_t j = 0; j < hypotheses_.size(); ++j) mean += rule_->weight(j) * cores_[j].rate(axis);
    return mean;
  }
  [[nodiscard]] double variance() const noexcept {
    if (hypotheses_.size() == 1) return cores_[0].variance();
    double mean = 0.0;
    for (std::size_t j = 0; j < hypotheses_.size(); ++j) mean += rule_->weight(j) * cores_[j].variance();
    return mean;
  }
  // Part of an innovation that goes into the rate.
  [[nodiscard]] double gain() const noexcept {
    if (hypotheses_.size() == 1) return cores_[0].h.dot(cores_[0].gain);
    double mean = 0.0;
    for (std::size_t j = 0; j < hypotheses_.size(); ++j)
      mean += rule_->weight(j) * cores_[j].h.dot(cores_[j].gain);
    return mean;
  }
  // The first (with one hypothesis: the only) core's, for the settled filter's lag.
  [[nodiscard]] const Core& core() const noexcept { return cores_[rule_->likeliest()]; }
  [[nodiscard]] const typename Core::Matrix& transition() const noexcept { return transition_; }
  [[nodiscard]] Rule& rule() noexcept { return *rule_; }
  [[nodiscard]] const Rule& rule() const noexcept { return *rule_; }

  // Takes in the measurements of `count` axes; returns the innovation covariance used. With learn off the
  // rule keeps its opinion of R: the innovations of a filter that is catching up say nothing about it.
  double update(const std::array<int, kMaxAxes>& axes, const Axes& rates, std::size_t count,
                double noise_scale, std::uint64_t sequence, bool learn) noexcept {
    double used = 0.0;
    for (std::size_t j = 0; j < hypotheses_.size(); ++j) {
      Core& core = cores_[j];
      Axes innovations{};
      for (std::size_t i = 0; i < count; ++i) innovations[i] = rates[i] - core.rate(axes[i]);
      const double projected = core.variance();
      const double c = learn ? rule_->innovation_covariance(
                                   {projected, noise_scale, {innovations.data(), count}, sequence, j})
                             : projected + rule_->measurement_noise() * noise_scale;
      core.correct(c);
      for (std::size_t i = 0; i < count; ++i) core.update(axes[i], innovations[i]);
      if (j == 0) used = c;
    }
    return used;
  }

  // No measurement taken in at this step.
  void skip() noexcept {
    for (Core& core : cores_) core.gain.setZero();
  }

  // Moves the rate of an axis, leaving what the model holds beside the level (a line, a slope) alone.
  void shift_to(int axis, double rate) noexcept {
    for (Core& core : cores_) core.x.col(axis) += level_ * (rate - core.rate(axis));
  }
  // Raises P so that the rate's variance is at least this.
  void raise_to(double variance) noexcept {
    for (std::size_t j = 0; j < hypotheses_.size(); ++j) {
      const double missing = variance - cores_[j].variance();
      if (missing > 0.0) cores_[j].p += missing * level_ * level_.transpose();
    }
  }

  [[nodiscard]] bool sound() const noexcept {
    for (std::size_t j = 0; j < hypotheses_.size(); ++j) {
      const double v = cores_[j].variance();
      if (!(v >= 0.0 && v < 1e300) || !cores_[j].x.allFinite()) return false;
    }
    return true;
  }

 private:
  // Variance before the first measurement as a multiple of the measurement's: large enough to be forgotten
  // after one measurement, small enough to leave the covariance ten digits.
  static constexpr double kDiffuse = 1e6;

  std::unique_ptr<StateModel> model_;
  std::unique_ptr<Rule> rule_;
  std::span<const double> hypotheses_;
  double process_noise_, measurement_noise_;
  std::array<Core, Rule::kMaxHypotheses> cores_;
  typename Core::Vector level_;
  typename Core::Matrix transition_, driving_;
  double discretised_dt_s_ = -1.0;
};

}  // namespace ifog
