// SPDX-License-Identifier: Apache-2.0
// What the estimator does at each step: screen the measurement, filter it at rest or mix the followers of a
// manoeuvre, keep the angle, learn the noise, publish. README.md derives it.
#pragma once

#include <algorithm>
#include <memory>

#include "filters/estimator/change_test.h"
#include "filters/estimator/estimator.h"
#include "filters/estimator/ledger.h"
#include "filters/estimator/mix.h"
#include "filters/estimator/noise.h"
#include "filters/estimator/outliers.h"
#include "filters/estimator/rest_filter.h"
#include "filters/estimator/sample.h"
#include "filters/estimator/trackers.h"
#include "filters/estimator/unmeasured.h"

namespace ifog {

// How well the filter at rest does by its own innovations: their normalised square, and how alike neighbours are.
class Grades {
 public:
  // normalised: innovation over the standard deviation that the filter gives it.
  void take(std::size_t axis, double normalised, EstimatorHealth& health) noexcept {
    constexpr double kMemory = 512.0;
    Grade& grade = grades_[axis];
    grade.count = std::min(grade.count + 1.0, kMemory);
    grade.square += (normalised * normalised - grade.square) / grade.count;
    grade.product += (normalised * grade.last - grade.product) / grade.count;
    grade.last = normalised;
    health.nis_mean[axis] = grade.square;
    health.whiteness[axis] = grade.square > 0.0 ? grade.product / grade.square : 0.0;
  }

 private:
  struct Grade {
    double square = 1.0, product = 0.0, last = 0.0, count = 0.0;
  };
  std::array<Grade, kMaxAxes> grades_{};
};

// The two ways in which the rate is followed, and the state that belongs to them.
class Follower {
 public:
  Follower(std::size_t axes, double period_s, bool begins_moving) noexcept
      : trackers(axes), change(trackers), ledger(period_s), moving(begins_moving) {}

  // Lag of the filter at rest, samples; after a move at most the number of samples received since.
  [[nodiscard]] double lag() const noexcept {
    return std::max(1.0, std::min(settled_lag, since_moved + 1.0));
  }

  [[nodiscard]] bool in_manoeuvre() const noexcept {
    return moving && failed_nats >= kEvidence && mix.rest_weight() < 0.5;
  }

  Trackers trackers;
  ChangeTest change;
  Outliers outliers;
  Mix mix;
  Ledger ledger;
  bool moving;  // nobody knows at the beginning: rest has to be found
  // Nats by which the filter at rest has failed since nothing was known. A start at rest looks like a motion, and is
  // called one only once chance does not explain them.
  double failed_nats = 0.0;
  double settled_lag = 0.0;         // of the filter at rest, samples, once it has settled
  double since_moved = 0.0;         // samples that the filter at rest has had since it was moved
  double at_rest_for = 0.0;         // samples since rest was found
  bool settled = false;             // the filter at rest gets back by itself what it lags behind by
  Lanes published = Lanes::Zero();  // the last rate, without payments
};

class Engine {
 public:
  Engine(const FilterSettings& settings, const KnownNoise& known, std::unique_ptr<RestFilter> rest, int axes,
         double period_s);

  void step(const EstimatorInput& in, EstimatorOutput& out) noexcept;
  void owe(const Axes& angle_rad) noexcept;
  [[nodiscard]] Axes owed() const noexcept;
  [[nodiscard]] const EstimatorHealth& health() const noexcept { return health_; }
  [[nodiscard]] LearnedNoise learned() const noexcept { return noise_.learned(); }

 private:
  // What one step knows.
  struct Step {
    const EstimatorInput& in;
    EstimatorOutput& out;
    double dt_s;
    double noise_scale;  // variance of a measurement over that of the nominal period
    Sample sample;
    Lanes rate = Lanes::Zero(), variance = Lanes::Zero();
    double gain = 0.0;
    bool outlier = false;
  };

  void restart() noexcept;  // forgets the state, keeps the counters
  void screen(Step& s) noexcept;
  void weigh(Step& s) noexcept;
  void begin_axes(const Step& s) noexcept;
  void follow(Step& s) noexcept;
  void jump(Step& s) noexcept;
  void follow_rest(Step& s) noexcept;
  void follow_manoeuvre(Step& s) noexcept;
  void begin_manoeuvre(Step& s, std::size_t tracker) noexcept;
  void take(Step& s, bool learn) noexcept;
  void move_rest(const Lanes& rate, const Lanes& variance) noexcept;
  void publish_rest(Step& s) noexcept;
  void publish_mix(Step& s) noexcept;
  void pay(Step& s) noexcept;
  void guard(Step& s) noexcept;
  void learn(const Step& s) noexcept;
  void publish(const Step& s) noexcept;
  void refresh_lag() noexcept;
  [[nodiscard]] bool rests(const Step& s) const noexcept;

  FilterSettings settings_;
  bool smooths_;  // what exceeds the known noise is noise
  bool follows_;  // motion, beside the filter at rest
  std::size_t axes_;
  double period_s_;
  std::unique_ptr<RestFilter> rest_;
  SensorNoise noise_;
  Follower follow_;
  Unmeasured unmeasured_;
  Grades grades_;
  EstimatorHealth health_;
  std::uint32_t started_ = 0;  // axes that have had a measurement
};

}  // namespace ifog
