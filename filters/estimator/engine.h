// SPDX-License-Identifier: Apache-2.0
// What the estimator does at each step: screen the measurement, let the filter at rest or the mix of a
// manoeuvre have it, book the angle, publish.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "filters/estimator/angle_ledger.h"
#include "filters/estimator/change_test.h"
#include "filters/estimator/doubted_motion.h"
#include "filters/estimator/estimator.h"
#include "filters/estimator/foresight.h"
#include "filters/estimator/motion_mix.h"
#include "filters/estimator/noise_scale.h"
#include "filters/estimator/outlier_run.h"
#include "filters/estimator/rest_filter.h"
#include "filters/estimator/sensor_check.h"
#include "filters/estimator/steady_gain.h"
#include "filters/estimator/tracker_bank.h"
#include "filters/estimator/unmeasured.h"

namespace ifog {

// Of a set of axes, bit i.
[[nodiscard]] constexpr bool has(std::uint32_t set, std::size_t axis) noexcept {
  return (set >> axis & 1U) != 0;
}

class Engine {
 public:
  // steady: the rule of `rest` when it is one whose gain is averaged, else null.
  Engine(const FilterSettings& settings, std::unique_ptr<RestFilter> rest, SteadyGain* steady, int axes,
         double period_s);

  void step(const EstimatorInput& in, EstimatorOutput& out) noexcept;
  void restart() noexcept;
  void retune(double process_noise, double walk) noexcept {
    rest_->retune(process_noise);
    walk_ = walk;
  }
  void recall_colour(const Axes& colour) noexcept;
  void expect_noise(const Axes& share) noexcept;
  void expect_walk(const std::optional<Axes>& share) noexcept { walk_share_ = share; }
  [[nodiscard]] Axes owed() const noexcept;
  void owe(const Axes& angle_rad) noexcept;
  [[nodiscard]] const EstimatorHealth& health() const noexcept { return health_; }

 private:
  enum class Motion {
    beginning,  // rest or motion, nobody knows: followed by the trackers, and by rest as it earns it
    at_rest,
    manoeuvre,  // followed by the trackers
  };
  enum class Knowledge {
    nothing,  // no measurement has come
    told,     // R is what the filter was told
    heard,    // R is what was heard at rest
  };
  [[nodiscard]] bool in_manoeuvre() const noexcept { return motion_ == Motion::manoeuvre; }
  [[nodiscard]] bool beginning() const noexcept { return motion_ == Motion::beginning; }

  // What one step knows of its measurement.
  struct Measurement {
    const EstimatorInput& in;
    std::uint32_t valid = 0;
    double dt_s = 0.0, noise_scale = 1.0;
    double to_nominal = 1.0;   // by which it is scaled to the nominal period's noise
    Axes innovation{};         // of the filter at rest; zero where not valid
    std::uint32_t tested = 0;  // axes whose noise was known before
    [[nodiscard]] double covered_s(std::size_t axis) const noexcept {
      return in.covered_s[axis] > 0.0 ? in.covered_s[axis] : dt_s;
    }
  };
  // Of the published rate, payments left out.
  struct Published {
    Axes rate{}, variance{};
    Axes returned{};  // of the variance, what is lag that payments return
    Axes shared{};    // what noise adds to it that the rate and payments for it have in common
    double gain = 0.0;
    bool passed_over = false;  // an outlier, as it looks now: no rotation
  };

  [[nodiscard]] std::uint32_t screen(const EstimatorInput& in, EstimatorOutput& out) noexcept;
  void begin_axes(const Axes& rate, std::uint32_t valid) noexcept;
  void begin() noexcept;
  void begin_after_gap(const Measurement& m) noexcept;
  void admit_kept_out() noexcept;
  void forget_kept_out() noexcept { kept_out_ = kept_out_s_ = {}; }
  void begin_kept_out() noexcept;
  void add_kept_out(const Measurement& m, std::size_t axis, double apart) noexcept;
  void book_kept_out(const Measurement& m) noexcept;
  void follow_beginning(const Measurement& m, const Surprise& now, EstimatorOutput& out) noexcept;
  void take_in(const Measurement& m, const Surprise& now) noexcept;
  void wait(const Measurement& m, const Surprise& now, EstimatorOutput& out) noexcept;
  void judge_beginning(const Measurement& m, bool changed, EstimatorOutput& out) noexcept;
  // Of none of these axes the noise is known by a long rest.
  [[nodiscard]] bool hardly_known(std::uint32_t axes) const noexcept;
  void doubt_motion() noexcept;
  void find_moving(const Measurement& m, EstimatorOutput& out) noexcept;
  [[nodiscard]] bool heard(std::uint32_t axes) const noexcept;
  void update_rest(const Measurement& m, bool learn) noexcept;
  [[nodiscard]] Surprise surprise(const Measurement& m) const noexcept;
  void follow(const Measurement& m, EstimatorOutput& out) noexcept;
  void follow_rest(const Measurement& m, const Surprise& now, EstimatorOutput& out) noexcept;
  void follow_manoeuvre(const Measurement& m, const Surprise& now, EstimatorOutput& out) noexcept;
  [[nodiscard]] bool still_waiting(std::uint32_t valid) noexcept;
  [[nodiscard]] bool unforeseen(const Measurement& m, const Surprise& now, Axes& least) noexcept;
  void average_rest(double predicted) noexcept;
  void expect_surprise(const Axes& least) noexcept;
  void know_unmeasured(const Measurement& m, double grown) noexcept;
  void forget_unmeasured(std::uint32_t valid) noexcept;
  void hear(const Measurement& m) noexcept;
  // of: axes that learn of it.
  void learn_noise(const Measurement& m, std::uint32_t of) noexcept;
  void jump(EstimatorOutput& out) noexcept;
  void begin_again(const Measurement& m, const Surprise& now, const Axes& least) noexcept;
  void judge_manoeuvre() noexcept;
  void come_to_rest() noexcept;
  void begin_manoeuvre(const Measurement& m, std::size_t tracker, EstimatorOutput& out) noexcept;
  [[nodiscard]] bool of_blow(std::size_t axis, double seen_over) const noexcept;
  void owe_to_manoeuvre(std::size_t axis, double seen_over) noexcept;
  void move_rest(const Axes& rate, double variance) noexcept;
  void guard(const Measurement& m, EstimatorOutput& out) noexcept;
  [[nodiscard]] bool rests(const Measurement& m) const noexcept;
  void publish_rest() noexcept;
  void publish_mix(const Surprise& now) noexcept;
  void publish(const Measurement& m, EstimatorOutput& out) noexcept;
  void grade(std::size_t axis, double normalised) noexcept;
  void doubt(std::size_t axis, double normalised) noexcept;
  // Noise as it is now over what the filter at rest has learned, 1 where they agree. What is learned slowly,
  // or not at all under way, comes too late for a filter that has just been moved: it would know its rate as
  // well as in the quiet, and be as slow as that once it has heard how loud it is.
  [[nodiscard]] double louder_by(std::uint32_t valid) const noexcept;
  [[nodiscard]] bool hardly_tested(std::size_t axis) const noexcept;
  [[nodiscard]] std::uint32_t learning(std::uint32_t valid) const noexcept;
  [[nodiscard]] Axes colours() const noexcept;
  void refresh_lag() noexcept;
  [[nodiscard]] double lag_samples() const noexcept;
  // The filter's own figures are for the mean of all axes. Those of one, whose gain is the same, are as much
  // larger as its noise is louder.
  [[nodiscard]] double rest_variance(std::size_t axis) const noexcept {
    return loudness_[axis] * rest_->variance();
  }
  // Angle of the measurements that are kept out now, of which it is not known yet what they are.
  [[nodiscard]] double kept_out(std::size_t axis) const noexcept {
    return !in_manoeuvre() && (waiting_ || !outliers_.run().empty()) ? kept_out_[axis] : 0.0;
  }
  [[nodiscard]] double innovation_variance(std::size_t axis) const noexcept {
    return loudness_[axis] * rest_->covariance();
  }
  [[nodiscard]] double walk_share(std::size_t axis) const noexcept {
    return walk_ * (walk_share_ ? (*walk_share_)[axis] : loudness_[axis]);
  }

  // Average of the filter at rest, in samples.
  static constexpr double kRestMemory = 64.0;
  // So many measurements after the first of a row that was kept out a motion that is found began with it.
  static constexpr double kBlow = 64.0;

  bool follow_manoeuvres_, conserve_angle_, guard_;
  std::size_t axes_;
  double period_s_;
  std::unique_ptr<RestFilter> rest_;
  SteadyGain* steady_;
  SensorCheck check_;
  std::array<NoiseScale, kMaxAxes> noise_;
  std::array<Foresight, kMaxAxes> foresight_;
  TrackerBank trackers_;
  ChangeTest change_;
  DoubtedMotion doubted_motion_;
  OutlierRun outliers_;
  MotionMix mix_;
  AngleLedger ledger_;
  Unmeasured unmeasured_;
  EstimatorHealth health_;

  struct Grade {
    double count = 0.0, square = 0.0, product = 0.0, last = 0.0;
    double beyond = 0.0;  // share of innovations far outside their own variance
  };
  std::array<Grade, kMaxAxes> grades_{};

  Published published_;
  std::uint32_t started_ = 0;  // axes that have a state
  Knowledge knowledge_ = Knowledge::nothing;
  Motion motion_ = Motion::at_rest;
  bool heard_before_ = false;       // the noise, when it began
  double unmeasured_s_ = 0.0;       // time that no measurement has covered, since the last one
  bool waiting_ = false;            // the last measurement was foreseen by nobody: an outlier, or a jump
  bool lost_ = false;               // was found so, and has not been well since: guard()
  Axes tested_for_{};               // measurements since the noise was known
  Axes untested_{};                 // angle fallen short of while the noise was not known, or the test blunt
  Axes kept_out_{};                 // angle of the measurements kept out in a row
  Axes kept_out_s_{};               // that they covered
  double since_blow_ = kBlow;       // measurements since the first that was kept out, up to kBlow
  Axes waiting_rate_{};             // that measurement
  std::uint32_t waiting_axes_ = 0;  // that it had
  std::uint32_t waiting_for_ = 0;   // of these the ones that nobody foresaw
  std::uint32_t unforeseen_axes_ = 0;
  std::size_t waited_ = 0;          // samples since, without those
  Axes surprised_{};                // running mean of the least normalised square in the manoeuvre
  double noise_of_one_;             // variance of a measurement, as set
  double louder_ = 1.0;             // the noise at the last measurement, over what was learned
  double rest_variance_ = 0.0;      // of the predicted rate at rest, averaged
  double at_rest_for_ = 0.0;        // measurements since the end of the last manoeuvre
  bool in_tail_ = false;            // of a motion, until the filter at rest has settled
  double since_moved_ = 0.0;        // measurements since the filter at rest was last moved
  Axes loudness_{1.0, 1.0, 1.0};    // variance of an axis' noise over the mean of all
  std::optional<Axes> walk_share_;  // its driving noise over the settings'; not known: as its noise
  double walk_ = 1.0;               // the rate's driving noise over the one that the gain is for
  double heard_scale_ = 1.0;        // Measurement::noise_scale of the last one
  Axes unheard_s_{};                // since each axis' last measurement
  double lag_s_ = 0.0;
  double longest_lag_ = 0.0;  // samples
  static constexpr std::uint64_t kNoTurn = ~std::uint64_t{0};
  std::uint64_t lag_turn_ = kNoTurn;  // of the last refresh of the lag
};

}  // namespace ifog
