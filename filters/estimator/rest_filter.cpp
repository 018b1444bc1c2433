// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/rest_filter.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace ifog {
namespace {

// Large enough to be forgotten after one measurement, small enough to leave ten digits.
constexpr double kDiffuse = 1e6;

// Calls f with the core, of one or two states in a fixed size. More states would save a fifth of their microsecond a
// step, and take 25 s more to compile.
template <int n, class F>
[[gnu::always_inline]] inline void fixed(KalmanCore<Eigen::Dynamic>& core, const F& f) {
  KalmanCore<n> small{core.x.template topRows<n>(), core.p.template topLeftCorner<n, n>(),
                      core.h.template head<n>(), core.gain.template head<n>()};
  f(small);
  core.x = small.x;
  core.p = small.p;
  core.gain = small.gain;
}
template <class F>
[[gnu::always_inline]] inline void sized(KalmanCore<Eigen::Dynamic>& core, const F& f) {
  if (core.h.size() == 1) return fixed<1>(core, f);
  if (core.h.size() == 2) return fixed<2>(core, f);
  f(core);
}

}  // namespace

RestFilter::RestFilter(std::unique_ptr<StateModel> model, std::unique_ptr<Rule> rule, double process_noise,
                       double measurement_noise)
    : rule_(std::move(rule)), hypotheses_(rule_->hypotheses()), process_noise_(process_noise) {
  const int n = model->states();
  if (n < 1 || n > kMaxStates)
    throw std::invalid_argument("state: " + std::to_string(n) + " states in all, expected 1 to " +
                                std::to_string(kMaxStates));
  model_ = {nullptr,
            n,
            model->measurement(),
            model->level(),
            model->rate(),
            {},
            (model->colour().diagonal().array() == 0.0).cast<double>(),
            process_noise * model->stationary(),
            process_noise * model->colour(),
            model->rate() == model->measurement(),
            measurement_noise};
  model_.clean = model_.h.cwiseProduct(model_.kept);
  model_.start.diagonal() += kDiffuse * measurement_noise * model->start();
  model_.form = std::move(model);
  transition_.resize(n, n);
  driving_.resize(n, n);
  restart();
}

double RestFilter::colour_of_sum(double keep, double period_s) const {
  if (model_.rate_alone) return 1.0;
  const Eigen::Index n = model_.states;
  Eigen::MatrixXd transition(n, n), driving(n, n);
  model_.form->discretise(period_s, transition, driving);
  transition *= keep;
  const Eigen::VectorXd shared = model_.colour * model_.h;
  const Eigen::MatrixXd ahead = Eigen::MatrixXd::Identity(n, n) - transition;
  const double later = model_.h.dot(ahead.partialPivLu().solve(transition * shared));
  const double all = model_.white + model_.h.dot(shared);
  // The colour adds no less than nothing, whatever is rounded.
  return std::max(1.0 + 2.0 * later / all, model_.white / all);
}

void RestFilter::restart() noexcept {
  const Eigen::Index n = model_.states;
  for (Core& core : cores_) {
    core.x.setZero(n, kMaxAxes);
    core.p = model_.start;
    core.h = model_.h;
    core.gain.setZero(n);
  }
  rule_->restart();
  refresh();
}

void RestFilter::predict(double dt_s) noexcept {
  if (dt_s != discretised_dt_s_) {
    discretised_dt_s_ = dt_s;
    model_.form->discretise(dt_s, transition_, driving_);
    driving_ *= process_noise_;
  }
  for (std::size_t j = 0; j < hypotheses_.size(); ++j)
    sized(cores_[j], [&](auto& core) { core.predict(transition_, driving_, hypotheses_[j]); });
  refresh();
}

void RestFilter::update(const Measured& m, std::uint64_t sequence, bool learn) noexcept {
  // The published innovation is that of the weighted mean prediction. Its variance is made of each core's
  // covariance and its distance from the mean, with the weights before this measurement.
  const bool alike = (m.share == 1.0).all();
  const Lanes predicted = measured().value;
  double mixture = 0.0;
  valid_ = m.valid;
  for (std::size_t j = 0; j < hypotheses_.size(); ++j) {
    const double weight = rule_->weight(j);
    const Reading before = hypotheses_.size() == 1 ? measured() : read(model_.h, cores_[j]);
    const Lanes innovation = m.rate - before.value;
    Axes normalised{};
    std::size_t count = 0;
    for (int axis = 0; axis < kMaxAxes; ++axis)
      if ((m.valid >> static_cast<unsigned>(axis) & 1U) != 0)
        normalised[count++] = alike ? innovation[axis] : innovation[axis] / std::sqrt(m.share[axis]);
    const double c = learn ? rule_->innovation_covariance(
                                 {before.variance, m.noise_scale, {normalised.data(), count}, sequence, j})
                           : before.variance + rule_->measurement_noise_of(j) * m.noise_scale;
    sized(cores_[j], [&](auto& core) {
      core.correct(c);
      for (int axis = 0; axis < kMaxAxes; ++axis)
        if ((m.valid >> static_cast<unsigned>(axis) & 1U) != 0) core.update(axis, innovation[axis]);
    });
    mixture += weight * (apart(before.value, predicted) + c);
  }
  covariance_ = mixture;
  refresh();
}

void RestFilter::skip() noexcept {
  for (Core& core : cores()) core.gain.setZero();
  rate_.gain = 0.0;
  covariance_ = measured().variance + rule_->measurement_noise();
}

void RestFilter::shift_to(const Lanes& rate, std::uint32_t which) noexcept {
  for (Core& core : cores()) {
    const Lanes now = read(model_.clean, core).value;
    for (int axis = 0; axis < kMaxAxes; ++axis)
      if ((which >> static_cast<unsigned>(axis) & 1U) != 0)
        core.x.col(axis) =
            model_.kept.cwiseProduct(core.x.col(axis)) + model_.level * (rate[axis] - now[axis]);
  }
  refresh();
}

void RestFilter::set_variance(double variance) noexcept {
  for (Core& core : cores()) {
    if (!model_.rate_alone)
      core.p = model_.kept.asDiagonal() * core.p * model_.kept.asDiagonal() + model_.colour;
    const double now = read(model_.readout, core).variance;
    if (variance >= now)
      core.p += (variance - now) * model_.level.lazyProduct(model_.level.transpose());
    else if (model_.rate_alone)
      core.p *= variance / now;
  }
  refresh();
}

// Weighted mean of a bank: if the model keeps a constant rate every G(1) is one, and the delay of a sum of
// filters is the sum of their delays.
Settled RestFilter::settled() const noexcept {
  Settled mean;
  for (std::size_t j = 0; j < hypotheses_.size(); ++j) {
    const Core& core = cores_[j];
    const Settled one = ifog::settled(transition_, model_.h, model_.readout, core.gain, core.p);
    mean.lag += rule_->weight(j) * one.lag;
    mean.correlation += rule_->weight(j) * one.correlation;
  }
  return mean;
}

bool RestFilter::sound() const noexcept {
  return std::all_of(cores_.begin(), cores_.begin() + std::ssize(hypotheses_), [&](const Core& core) {
    const double v = read(model_.h, core).variance;
    return v >= 0.0 && v < 1e300 && core.x.allFinite();
  });
}

void RestFilter::refresh() noexcept {
  rate_ = read(model_.readout);
  if (!model_.rate_alone) measured_ = read(model_.h);
}

RestFilter::Reading RestFilter::read(const FewStatesVector& of, const Core& core) const noexcept {
  // A single state is the rate itself, so no product is needed.
  if (of.size() == 1) return {{core.x(0, 0), core.x(0, 1), core.x(0, 2), 0.0}, core.p(0, 0), core.gain[0]};
  Reading out{Lanes::Zero(), of.dot(core.p.lazyProduct(of)), of.dot(core.gain)};
  for (int axis = 0; axis < kMaxAxes; ++axis) out.value[axis] = of.dot(core.x.col(axis));
  return out;
}

RestFilter::Reading RestFilter::read(const FewStatesVector& of) const noexcept {
  if (hypotheses_.size() == 1) return read(of, cores_[0]);
  Reading mean;
  std::array<Reading, Rule::kMaxHypotheses> each;
  for (std::size_t j = 0; j < hypotheses_.size(); ++j) {
    each[j] = read(of, cores_[j]);
    mean.value += rule_->weight(j) * each[j].value;
    mean.gain += rule_->weight(j) * each[j].gain;
  }
  for (std::size_t j = 0; j < hypotheses_.size(); ++j)
    mean.variance += rule_->weight(j) * (each[j].variance + apart(each[j].value, mean.value));
  return mean;
}

// Mean square, over measured axes, of the distance from the mean prediction; zero for a single core.
double RestFilter::apart(const Lanes& one, const Lanes& mean) const noexcept {
  if (hypotheses_.size() == 1 || valid_ == 0) return 0.0;
  double sum = 0.0;
  for (int axis = 0; axis < kMaxAxes; ++axis)
    if ((valid_ >> static_cast<unsigned>(axis) & 1U) != 0)
      sum += (one[axis] - mean[axis]) * (one[axis] - mean[axis]);
  return sum / std::popcount(valid_);
}

}  // namespace ifog
