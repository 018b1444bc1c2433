// What the estimator does at each step: screen the measurement, let the filter at rest or the trackers of a
// manoeuvre have it, book the angle, publish.
#pragma once

#include <memory>
#include <span>

#include "filters/estimator/angle_ledger.h"
#include "filters/estimator/estimator.h"
#include "filters/estimator/fading_trackers.h"
#include "filters/estimator/innovation_monitor.h"
#include "filters/estimator/noise_or_motion.h"
#include "filters/estimator/rest_filter.h"
#include "filters/estimator/sensor_check.h"

namespace ifog {

class Engine {
 public:
  Engine(const FilterSettings& settings, std::unique_ptr<RestFilter> rest, int axes, double period_s);

  void step(const EstimatorInput& in, EstimatorOutput& out) noexcept;
  void restart() noexcept;
  [[nodiscard]] Axes owed() const noexcept;
  void owe(const Axes& angle_rad) noexcept;
  [[nodiscard]] const EstimatorHealth& health() const noexcept { return health_; }

 private:
  // Measurements kept for starting the trackers at the beginning of a change.
  static constexpr std::size_t kHistory = 16;

  // What one step knows of its measurement.
  struct Measurement {
    const EstimatorInput& in;
    std::uint32_t valid = 0;
    double dt_s = 0.0, noise_scale = 1.0;
    Axes innovation{};  // of the filter at rest; zero where not valid
    [[nodiscard]] double covered_s(std::size_t axis) const noexcept {
      return in.covered_s[axis] > 0.0 ? in.covered_s[axis] : dt_s;
    }
  };

  [[nodiscard]] std::uint32_t screen(const EstimatorInput& in, EstimatorOutput& out) noexcept;
  void begin_axes(const Axes& rate, std::uint32_t valid) noexcept;
  void update_rest(const Measurement& m, bool learn) noexcept;
  void follow(const Measurement& m, EstimatorOutput& out) noexcept;
  void follow_rest(const Measurement& m) noexcept;
  void follow_manoeuvre(const Measurement& m, const InnovationMonitor::Verdict& verdict,
                        EstimatorOutput& out) noexcept;
  void begin_manoeuvre(int since, EstimatorOutput& out) noexcept;
  void end_manoeuvre() noexcept;
  void hold(const Measurement& m, EstimatorOutput& out) noexcept;
  void admit_held() noexcept;
  void judge_noise(const Measurement& m) noexcept;
  void jump(int since) noexcept;
  void remember(const Axes& rate, std::uint32_t valid) noexcept;
  [[nodiscard]] std::span<const Axes> recent(std::size_t count) noexcept;
  [[nodiscard]] bool far_from_rest(const Measurement& m) const noexcept;
  [[nodiscard]] double noise(std::size_t axis) const noexcept;
  void guard(const Measurement& m, EstimatorOutput& out) noexcept;
  void publish(const Measurement& m, EstimatorOutput& out) noexcept;
  void grade(std::size_t axis, double innovation, double variance) noexcept;
  void refresh_lag() noexcept;

  bool follow_manoeuvres_, conserve_angle_;
  std::size_t axes_;
  double period_s_;
  std::unique_ptr<RestFilter> rest_;
  SensorCheck check_;
  InnovationMonitor monitor_;
  NoiseOrMotion noise_or_motion_;
  FadingTrackers trackers_;
  AngleLedger ledger_;
  EstimatorHealth health_;

  struct Grade {
    double count = 0.0, square = 0.0, product = 0.0, last = 0.0;
    double beyond = 0.0;  // share of innovations far outside their own variance
  };
  std::array<Grade, kMaxAxes> grades_{};

  std::uint32_t started_ = 0, booked_ = 0;  // axes that have a state, axes whose angle is being kept
  bool first_ = true, in_manoeuvre_ = false, held_ = false, settling_ = false, lost_ = false;
  int quiet_ = 0, calm_ = 0, until_lag_ = 0;
  int manoeuvre_samples_ = 0;
  std::int64_t steps_ = 0;
  double rest_gain_ = 0.0;          // of the measurement at rest, averaged
  double settling_variance_ = 0.0;  // of the rate after the last measurement while P settles
  double lag_s_ = 0.0;
  Axes held_angle_{}, last_output_{};
  std::array<Axes, kHistory> history_{}, recent_{};
  std::size_t history_at_ = 0, history_length_ = 0;
};

}  // namespace ifog
