// SPDX-License-Identifier: Apache-2.0
// Steps of the estimator: screen the measurement, filter it at rest or mix the trackers of a manoeuvre, keep
// the angle, learn the noise, publish. README.md derives them.
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

// Quality of the filter at rest from its innovations: mean normalised square and autocorrelation at lag 1.
class Grades {
 public:
  // normalised: innovation / its predicted standard deviation.
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

// The two estimates of the rate (trackers and filter at rest) and their state.
class Follower {
 public:
  Follower(std::size_t axes, double period_s, bool begins_moving, const RestFilter& rest)
      : trackers(axes),
        change(trackers, [&](double keep) { return rest.colour_of_sum(keep, period_s); }),
        ledger(period_s),
        moving(begins_moving) {}

  // Lag of the filter at rest, samples; at most the number of samples since it was reset.
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
  bool moving;  // true at the start: rest must be detected
  // Evidence in nats against the filter at rest since the start. A start at rest looks like a motion, so it
  // is reported as a manoeuvre only with significant evidence.
  double failed_nats = 0.0;
  double settled_lag = 0.0;         // in samples, of the settled filter at rest
  double since_moved = 0.0;         // samples of the filter at rest since it was reset
  double at_rest_for = 0.0;         // samples since rest was detected
  bool settled = false;             // the filter at rest recovers its lag by itself
  Lanes published = Lanes::Zero();  // last rate, without angle payments
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
  // Data of one step.
  struct Step {
    const EstimatorInput& in;
    EstimatorOutput& out;
    double dt_s;
    double noise_scale;  // variance of the measurement / that at the nominal period
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
  void wait(Step& s) noexcept;
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
  bool follows_;  // tracks motion, in addition to the filter at rest
  std::size_t axes_;
  double period_s_;
  std::unique_ptr<RestFilter> rest_;
  SensorNoise noise_;
  Follower begins_, follow_;  // at the start, and now
  Unmeasured unmeasured_;
  Grades grades_;
  EstimatorHealth health_;
  std::uint32_t started_ = 0;  // axes that have had a measurement
};

}  // namespace ifog
