// SPDX-License-Identifier: Apache-2.0
// Trackers of rate, slope and curvature that forget at different speeds: from one sample, which is the
// measured rate itself, to as long as the filter at rest, half a power of ten apart.
//
// A tracker is the fading-memory polynomial filter of second degree (Morrison, "Introduction to Sequential
// Smoothing and Prediction", 1969; Brookner, "Tracking and Kalman Filtering Made Easy", 1998, section 7):
// three equal poles at theta, gains 1 - theta^3, 3/2 (1 - theta)^2 (1 + theta), (1 - theta)^3. Of rate to
// output 1 - H is the cube of a first difference: no lag on a constant slope or curvature, and a gain that
// departs from one only with the fourth power of frequency, which is what keeps coning out of the angle. A
// young tracker is the least-squares parabola through all measurements since it began. All axes share the
// gains.
#pragma once

#include <array>
#include <cstddef>

#include "filters/estimator/sample.h"

namespace ifog {

class Trackers {
 public:
  // Up to 1.4e5 samples.
  static constexpr std::size_t kMost = 11;
  // Measurements that a parabola goes through: a younger tracker predicts nothing.
  static constexpr double kParabola = 3.0;
  // Prediction variance over R of a tracker that knows nothing.
  static constexpr double kUnknown = 1e6;

  struct Gains {
    double rate = 1.0, slope = 0.0, curvature = 0.0;
    double factor = kUnknown, log_factor = 13.8;  // variance of an innovation over R
    double output = 1.0;                          // variance of the filtered rate over R
  };

  // axes: of the sensor, the first lanes.
  explicit Trackers(std::size_t axes = kMaxAxes) noexcept;

  // Trackers as long as this many samples take part; once in they stay.
  void reach(double samples) noexcept;
  // All of them afresh: they know nothing.
  void begin() noexcept;
  // This one and all longer ones continue from the state of a shorter one.
  void begin_from(std::size_t tracker, std::size_t from) noexcept;
  // One step of so many nominal samples.
  void predict(double steps) noexcept;
  // mask: 1 for the axes that are measured, else 0.
  void correct(const Lanes& rate, const Lanes& mask) noexcept;
  // First measurements of the axes with mask 1: they have no slope yet.
  void seed(const Lanes& rate, const Lanes& mask) noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  // After predict() the rate one step ahead, after correct() the filtered one.
  [[nodiscard]] const Lanes& rate(std::size_t j) const noexcept { return state_[j].rate; }
  [[nodiscard]] const Gains& gains(std::size_t j) const noexcept { return state_[j].gains; }
  // Prediction variance over R of each axis, whose last measurement is since() samples old.
  [[nodiscard]] Lanes factor(std::size_t j) const noexcept;
  [[nodiscard]] bool predicts(std::size_t j) const noexcept { return state_[j].age >= kParabola; }
  // What it has of its memory by now, samples.
  [[nodiscard]] double length(std::size_t j) const noexcept { return state_[j].length; }
  // Samples over which it is compared with another filter: its impulse response has decayed.
  [[nodiscard]] double horizon(std::size_t j) const noexcept { return horizon_[j]; }
  // By how much the parabola's reach is longer than itself for each axis; 1 for one that has just been measured.
  [[nodiscard]] Lanes prolonged(std::size_t j) const noexcept {
    return 1.0 + (since_ / state_[j].length).min(kMostLengths);
  }
  // Nominal samples since each axis was corrected; 1 when none is missing.
  [[nodiscard]] const Lanes& since() const noexcept { return since_; }

 private:
  struct State {
    Lanes rate = Lanes::Zero(), slope = Lanes::Zero(),
          curvature = Lanes::Zero();  // per sample, half per sample^2
    double age = 0.0, length = 1.0;
    bool settled = false;
    Gains gains{};
  };

  void grow_to(State& state, std::size_t j, double age) const noexcept;
  void set_gains(State& state, std::size_t j) const noexcept;
  void prolong(State& state, double steps) const noexcept;
  void correct_some(State& state, const Lanes& rate, const Lanes& mask) noexcept;
  // Every axis was corrected at the last nominal sample.
  [[nodiscard]] bool all_since_last() const noexcept { return (axes_ * (since_ - 1.0)).abs().sum() == 0.0; }
  // Axes that have been missing for longer than the parabola reaches.
  [[nodiscard]] auto ended(const State& state) const noexcept { return since_ > kMostLengths * state.length; }

  // A parabola is prolonged over so many of its lengths at most: beyond, its variance exceeds a thousand times
  // R.
  static constexpr double kMostLengths = 4.0;
  Lanes axes_;  // 1 for those that the sensor has
  std::array<double, kMost> memory_{}, horizon_{};
  std::array<Gains, kMost> fading_{};
  std::array<State, kMost> state_{};
  std::size_t size_ = 0;
  Lanes since_ = Lanes::Zero();
};

}  // namespace ifog
