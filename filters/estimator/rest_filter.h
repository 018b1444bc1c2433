// SPDX-License-Identifier: Apache-2.0
// Filter at rest: state model, Kalman core and rule. One core for most rules; for a rule with several noise
// hypotheses one core each, and their weighted mean.
#pragma once

#include <array>
#include <memory>
#include <span>

#include "filters/estimator/sample.h"
#include "filters/kalman/core.h"
#include "filters/kalman/settled.h"
#include "filters/rules/rule.h"
#include "filters/state_models/few_states.h"
#include "filters/state_models/state_model.h"

namespace ifog {

class RestFilter {
 public:
  // Throws std::invalid_argument if the model has too many states.
  RestFilter(std::unique_ptr<StateModel> model, std::unique_ptr<Rule> rule, double process_noise,
             double measurement_noise);

  void restart() noexcept;
  // Changes the driving noise from the next prediction on.
  void retune(double process_noise) noexcept {
    process_noise_ = process_noise;
    discretised_dt_s_ = -1.0;
  }
  // Equations (9), (10) of the paper over dt.
  void predict(double dt_s) noexcept;
  // One sample. noise_scale: mean R of the valid axes / R of the constructor; share: R of each axis / that
  // mean, by which innovations are normalised for the rule.
  struct Measured {
    Lanes rate = Lanes::Zero();
    std::uint32_t valid = 0;
    double noise_scale = 1.0;
    Lanes share = Lanes::Ones();
  };
  // Corrects with a measurement. With learn off the rule keeps its R, because innovations of a filter that is
  // still settling are not representative.
  void update(const Measured& m, std::uint64_t sequence, bool learn) noexcept;
  // A step without measurement.
  void skip() noexcept;
  // Sets the level of the axes in `which` so that they measure `rate`, without colour. Lines remain.
  void shift_to(const Lanes& rate, std::uint32_t which) noexcept;
  // Sets the variance of the rate, in a larger model only to a larger one, and that of the colour at the start.
  void set_variance(double variance) noexcept;
  // Lag and correlation for the present gain in steady state.
  [[nodiscard]] Settled settled() const noexcept;
  // False if the covariance is invalid or the state is not finite.
  [[nodiscard]] bool sound() const noexcept;

  struct Reading {
    Lanes value = Lanes::Zero();
    double variance = 0.0, gain = 0.0;
  };
  // Results of the last call: the rate that is published; with the model's lines; and with its coloured noise as
  // well, as it is measured.
  [[nodiscard]] const Reading& rate() const noexcept { return rate_; }
  [[nodiscard]] Reading without_colour() const noexcept {
    return model_.rate_alone ? rate_ : read(model_.clean);
  }
  [[nodiscard]] const Reading& measured() const noexcept { return model_.rate_alone ? rate_ : measured_; }
  // True if the model has no coloured noise or lines, so the three are equal.
  [[nodiscard]] bool rate_alone() const noexcept { return model_.rate_alone; }
  // Variance of the model's coloured noise, (rad/s)^2.
  [[nodiscard]] double colour_variance() const noexcept { return model_.h.dot(model_.colour * model_.h); }
  // Variance of a sum of measurements at rest whose memory keeps the share `keep` from sample to sample, relative to that
  // of white noise: 1 + 2 sum keep^k rho_k, with the correlation rho of the model's noise.
  [[nodiscard]] double colour_of_sum(double keep, double period_s) const;
  [[nodiscard]] double covariance() const noexcept { return covariance_; }  // of the innovation, as used
  [[nodiscard]] Rule& rule() noexcept { return *rule_; }
  [[nodiscard]] const Rule& rule() const noexcept { return *rule_; }

 private:
  struct Model {
    std::unique_ptr<StateModel> form;
    Eigen::Index states;
    FewStatesVector h, level, readout;
    FewStatesVector clean, kept;    // h without the colour; 0 for the colour's states, else 1
    FewStatesMatrix start, colour;  // covariance at the start, and of the colour in steady state
    bool rate_alone;
    double white;  // R of a measurement without the colour, (rad/s)^2
  };
  using Core = KalmanCore<Eigen::Dynamic>;
  [[nodiscard]] std::span<Core> cores() noexcept { return {cores_.data(), hypotheses_.size()}; }
  // Value, variance and gain of `of`'x in one core, and in the weighted mean.
  [[nodiscard]] Reading read(const FewStatesVector& of, const Core& core) const noexcept;
  [[nodiscard]] Reading read(const FewStatesVector& of) const noexcept;
  void refresh() noexcept;
  [[nodiscard]] double apart(const Lanes& one, const Lanes& mean) const noexcept;

  Model model_;
  std::unique_ptr<Rule> rule_;
  std::span<const double> hypotheses_;
  double process_noise_, discretised_dt_s_ = -1.0;
  FewStatesMatrix transition_, driving_;
  std::array<Core, Rule::kMaxHypotheses> cores_;
  Reading rate_, measured_;
  double covariance_ = 0.0;
  std::uint32_t valid_ = 0;  // axes of the last measurement
};

}  // namespace ifog
