// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/rest_filter.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "filters/kalman/core.h"

namespace ifog {
namespace {

// The filter at rest for one number of states. One core for most rules; for a rule with several hypotheses
// about the noise, one core each and their weighted mean.
template <int n>
class SizedRestFilter final : public RestFilter {
 public:
  SizedRestFilter(std::unique_ptr<StateModel> model, std::unique_ptr<Rule> rule, double process_noise,
                  double measurement_noise)
      : RestFilter(std::move(rule)),
        model_(std::move(model)),
        hypotheses_(rule_->hypotheses()),
        process_noise_(process_noise),
        level_(model_->level()),
        readout_(model_->rate()),
        start_(process_noise * model_->stationary()) {
    // Large enough to be forgotten after one measurement, small enough to leave the covariance ten digits.
    constexpr double kDiffuse = 1e6;
    start_.diagonal() += kDiffuse * measurement_noise * model_->start();
    for (Core& core : cores_) core.h = model_->measurement();
    rate_alone_ = readout_ == cores_[0].h;
    restart();
  }

  void restart() noexcept override {
    for (Core& core : cores_) {
      core.x.setZero();
      core.p = start_;
    }
    rule_->restart();
    refresh();
  }

  void retune(double process_noise) noexcept override {
    process_noise_ = process_noise;
    discretised_dt_s_ = 0.0;
  }

  void predict(double dt_s) noexcept override {
    if (dt_s != discretised_dt_s_) {
      discretised_dt_s_ = dt_s;
      model_->discretise(dt_s, transition_, driving_);
      driving_ *= process_noise_;
    }
    for (std::size_t j = 0; j < hypotheses_.size(); ++j)
      cores_[j].predict(transition_, driving_, hypotheses_[j]);
    refresh();
  }

  void update(const Measured& m, std::uint64_t sequence, bool learn) noexcept override {
    // The innovation published is that of the weighted mean of predictions; each core's own covariance and
    // its distance from that mean make its variance, under the weights from before this measurement.
    const Lanes predicted = measurement_;
    double mixture = 0.0;
    valid_ = m.valid;
    for (std::size_t j = 0; j < hypotheses_.size(); ++j) {
      Core& core = cores_[j];
      const double weight = rule_->weight(j);
      mixture += weight * distance(core, core.h, predicted);
      Axes innovations{}, normalised{};
      std::array<int, kMaxAxes> axes{};
      std::size_t count = 0;
      for (int axis = 0; axis < Core::kAxes; ++axis) {
        if ((m.valid >> static_cast<unsigned>(axis) & 1U) == 0) continue;
        axes[count] = axis;
        innovations[count] = m.rate[axis] - core.rate(axis);
        normalised[count] =
            m.share[axis] == 1.0 ? innovations[count] : innovations[count] / std::sqrt(m.share[axis]);
        ++count;
      }
      const double projected = core.variance();
      const double c = learn ? rule_->innovation_covariance(
                                   {projected, m.noise_scale, {normalised.data(), count}, sequence, j})
                             : projected + rule_->measurement_noise_of(j) * m.noise_scale;
      core.correct(c);
      for (std::size_t i = 0; i < count; ++i) core.update(axes[i], innovations[i]);
      mixture += weight * c;
    }
    covariance_ = mixture;
    refresh();
  }

  void skip() noexcept override {
    for (Core& core : cores_) core.gain.setZero();
    gain_ = 0.0;
    covariance_ = measurement_variance_ + rule_->measurement_noise();
  }

  void shift_to(const Lanes& rate, std::uint32_t which) noexcept override {
    for (std::size_t j = 0; j < hypotheses_.size(); ++j) {
      Core& core = cores_[j];
      for (int axis = 0; axis < Core::kAxes; ++axis)
        if ((which >> static_cast<unsigned>(axis) & 1U) != 0)
          core.x.col(axis) += level_ * (rate[axis] - along(core.h, core, axis));
    }
    refresh();
  }

  void set_variance(double variance) noexcept override {
    for (std::size_t j = 0; j < hypotheses_.size(); ++j) {
      const double now = spread(readout_, cores_[j]);
      if (variance >= now)
        cores_[j].p += (variance - now) * level_ * level_.transpose();
      else
        cores_[j].p *= variance / now;
    }
    refresh();
  }

  // Of a bank the weighted mean: where the model holds a constant rate every G(1) is one, and the delay of a sum of
  // filters is the sum of their delays.
  Settled settled() const noexcept override {
    Settled mean;
    for (std::size_t j = 0; j < hypotheses_.size(); ++j) {
      const Settled one = ifog::settled(transition_, cores_[j].h, readout_, cores_[j].gain, cores_[j].p);
      mean.lag += rule_->weight(j) * one.lag;
      mean.correlation += rule_->weight(j) * one.correlation;
    }
    return mean;
  }

  bool sound() const noexcept override {
    for (std::size_t j = 0; j < hypotheses_.size(); ++j) {
      const double v = cores_[j].variance();
      if (!(v >= 0.0 && v < 1e300) || !cores_[j].x.allFinite()) return false;
    }
    return true;
  }

 private:
  using Core = KalmanCore<n>;

  void refresh() noexcept {
    read(readout_, rate_, variance_, gain_);
    if constexpr (n == 1) {
      // A single state is the rate, and all that is measured.
      measurement_ = rate_;
      measurement_variance_ = variance_;
    } else {
      double gain = 0.0;
      read(cores_[0].h, measurement_, measurement_variance_, gain);
    }
  }

  // What the cores make of `of`'x: value, variance, gain.
  void read(const typename Core::Vector& of, Lanes& value, double& variance, double& gain) const noexcept {
    if (hypotheses_.size() == 1) {
      for (int axis = 0; axis < Core::kAxes; ++axis) value[axis] = along(of, cores_[0], axis);
      variance = spread(of, cores_[0]);
      gain = of.dot(cores_[0].gain);
      return;
    }
    value.setZero();
    variance = gain = 0.0;
    for (std::size_t j = 0; j < hypotheses_.size(); ++j) {
      const double weight = rule_->weight(j);
      for (int axis = 0; axis < Core::kAxes; ++axis) value[axis] += weight * along(of, cores_[j], axis);
      gain += weight * of.dot(cores_[j].gain);
    }
    for (std::size_t j = 0; j < hypotheses_.size(); ++j)
      variance += rule_->weight(j) * (spread(of, cores_[j]) + distance(cores_[j], of, value));
  }

  // A single state is the rate itself: no product, each of which the next step would wait for.
  static double along(const typename Core::Vector& of, const Core& core, int axis) noexcept {
    if constexpr (n == 1) return core.x(0, axis);
    return of.dot(core.x.col(axis));
  }
  static double spread(const typename Core::Vector& of, const Core& core) noexcept {
    if constexpr (n == 1) return core.p(0, 0);
    return of.dot(core.p * of);
  }

  // Mean square over the measured axes of a core's `of`'x against this; zero by itself for a single core.
  double distance(const Core& core, const typename Core::Vector& of, const Lanes& mean) const noexcept {
    if (hypotheses_.size() == 1 || valid_ == 0) return 0.0;
    double sum = 0.0;
    for (int axis = 0; axis < Core::kAxes; ++axis) {
      if ((valid_ >> static_cast<unsigned>(axis) & 1U) == 0) continue;
      const double apart = along(of, core, axis) - mean[axis];
      sum += apart * apart;
    }
    return sum / std::popcount(valid_);
  }

  std::unique_ptr<StateModel> model_;
  std::span<const double> hypotheses_;
  double process_noise_;
  std::array<Core, Rule::kMaxHypotheses> cores_;
  typename Core::Vector level_, readout_;
  typename Core::Matrix start_, transition_, driving_;
  double discretised_dt_s_ = -1.0;
  std::uint32_t valid_ = 0;  // axes of the last measurement
};

// The filter for a model of n states or more.
template <int n>
std::unique_ptr<RestFilter> make(int states, std::unique_ptr<StateModel> model, std::unique_ptr<Rule> rule,
                                 double process_noise, double measurement_noise) {
  if constexpr (n < kMaxStates) {
    if (states > n)
      return make<n + 1>(states, std::move(model), std::move(rule), process_noise, measurement_noise);
  }
  return std::make_unique<SizedRestFilter<n>>(std::move(model), std::move(rule), process_noise,
                                              measurement_noise);
}

}  // namespace

std::unique_ptr<RestFilter> make_rest_filter(std::unique_ptr<StateModel> model, std::unique_ptr<Rule> rule,
                                             double process_noise, double measurement_noise) {
  const int states = model->states();
  if (states < 1 || states > kMaxStates) {
    throw std::invalid_argument("state: " + std::to_string(states) + " states in all, expected 1 to " +
                                std::to_string(kMaxStates));
  }
  return make<1>(states, std::move(model), std::move(rule), process_noise, measurement_noise);
}

}  // namespace ifog
