// SPDX-License-Identifier: Apache-2.0
// State model, Kalman core and rule put together: the filter at rest. The core is of fixed size, one
// instantiation for each number of states; this is what they have in common.
#pragma once

#include <memory>

#include "filters/estimator/sample.h"
#include "filters/kalman/settled.h"
#include "filters/rules/rule.h"
#include "filters/state_models/state_model.h"

namespace ifog {

class RestFilter {
 public:
  virtual ~RestFilter() = default;

  virtual void restart() noexcept = 0;
  // Another driving noise from the next prediction on.
  virtual void retune(double process_noise) noexcept = 0;
  // Eqs. (9), (10) of the paper over dt.
  virtual void predict(double dt_s) noexcept = 0;
  // One sample. noise_scale: mean R of the valid axes over the R that the filter was made with; share: R of
  // each axis over that mean, by which the rule's innovations are normalised.
  struct Measured {
    Lanes rate = Lanes::Zero();
    std::uint32_t valid = 0;
    double noise_scale = 1.0;
    Lanes share = Lanes::Ones();
  };
  // Takes it in. With learn off the rule keeps its opinion of R: the innovations of a filter that is catching
  // up say nothing about it.
  virtual void update(const Measured& m, std::uint64_t sequence, bool learn) noexcept = 0;
  // No measurement at this step.
  virtual void skip() noexcept = 0;
  // Moves the level of the axes in `which` until the measurement would be this, leaving what the model holds
  // beside it (a line, a slope) alone.
  virtual void shift_to(const Lanes& rate, std::uint32_t which) noexcept = 0;
  // Makes this the variance of the rate.
  virtual void set_variance(double variance) noexcept = 0;
  // Lag and correlation if the gain stayed as it is.
  [[nodiscard]] virtual Settled settled() const noexcept = 0;
  // False when the covariance is none any more or the state no number.
  [[nodiscard]] virtual bool sound() const noexcept = 0;

  // As the last of the calls above left them. Rate, its variance and its gain are of StateModel::rate(), what
  // is published; the measurement's are of everything that is measured, the noise's colour and lines
  // included.
  [[nodiscard]] const Lanes& rate() const noexcept { return rate_; }
  [[nodiscard]] double variance() const noexcept { return variance_; }
  [[nodiscard]] double gain() const noexcept { return gain_; }
  [[nodiscard]] const Lanes& measurement() const noexcept { return measurement_; }
  [[nodiscard]] double measurement_variance() const noexcept { return measurement_variance_; }
  // The rate is all that is measured: the model knows no colour and no line.
  [[nodiscard]] bool rate_alone() const noexcept { return rate_alone_; }
  [[nodiscard]] double covariance() const noexcept { return covariance_; }  // of the innovation, as used
  [[nodiscard]] Rule& rule() noexcept { return *rule_; }
  [[nodiscard]] const Rule& rule() const noexcept { return *rule_; }

 protected:
  explicit RestFilter(std::unique_ptr<Rule> rule) : rule_(std::move(rule)) {}

  std::unique_ptr<Rule> rule_;
  Lanes rate_ = Lanes::Zero(), measurement_ = Lanes::Zero();
  double variance_ = 0.0, gain_ = 0.0, covariance_ = 0.0;
  double measurement_variance_ = 0.0;
  bool rate_alone_ = true;
};

// Throws std::invalid_argument when the model has too many states.
std::unique_ptr<RestFilter> make_rest_filter(std::unique_ptr<StateModel> model, std::unique_ptr<Rule> rule,
                                             double process_noise, double measurement_noise);

}  // namespace ifog
