// SPDX-License-Identifier: Apache-2.0
// Trackers of rate, slope and curvature with memories from one sample (the measured rate) to the filter's at rest.
//
// A tracker is a fading-memory polynomial filter of second degree (Morrison, "Introduction to Sequential
// Smoothing and Prediction", 1969; Brookner, "Tracking and Kalman Filtering Made Easy", 1998, section 7):
// three equal poles at theta, gains 1 - theta^3, 3/2 (1 - theta)^2 (1 + theta), (1 - theta)^3. 1 - H is the
// cube of a first difference, which keeps coning out of the angle. A young tracker is the least-squares
// parabola through all measurements since its start.
#pragma once

#include <array>
#include <cstddef>

#include "filters/estimator/sample.h"

namespace ifog {

class Trackers {
 public:
  // Up to 1.4e5 samples.
  static constexpr std::size_t kMost = 11;
  // Measurements that define a parabola; a younger tracker predicts nothing.
  static constexpr double kParabola = 3.0;
  // Prediction variance / R of a tracker without data.
  static constexpr double kUnknown = 1e6;

  struct Gains {
    double rate = 1.0, slope = 0.0, curvature = 0.0;
    double factor = kUnknown, log_factor = 13.8;  // variance of an innovation / R
    double output = 1.0;                          // variance of the filtered rate / R
  };

  // axes: number of the sensor's axes, the first lanes.
  explicit Trackers(std::size_t axes = kMaxAxes) noexcept;

  // Enables trackers up to this memory; they are not disabled again.
  void reach(double samples) noexcept;
  // Restarts all trackers without data.
  void begin() noexcept;
  // This tracker and all longer ones continue from the state of a shorter one.
  void begin_from(std::size_t tracker, std::size_t from) noexcept;
  // Predicts over `steps` nominal samples.
  void predict(double steps) noexcept;
  // mask: 1 for measured axes, else 0.
  void correct(const Lanes& rate, const Lanes& mask) noexcept;
  // First measurements of the axes with mask 1; their slope is unknown.
  void seed(const Lanes& rate, const Lanes& mask) noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  // After predict() the predicted rate, after correct() the filtered one.
  [[nodiscard]] const Lanes& rate(std::size_t j) const noexcept { return state_[j].rate; }
  [[nodiscard]] const Gains& gains(std::size_t j) const noexcept { return state_[j].gains; }
  // Prediction variance / R of each axis, whose last measurement is since() samples old.
  [[nodiscard]] Lanes factor(std::size_t j) const noexcept;
  [[nodiscard]] bool predicts(std::size_t j) const noexcept { return state_[j].age >= kParabola; }
  // Effective memory so far, samples.
  [[nodiscard]] double length(std::size_t j) const noexcept { return state_[j].length; }
  // Samples over which it is compared with another filter; its impulse response has decayed then.
  [[nodiscard]] double horizon(std::size_t j) const noexcept { return horizon_[j]; }
  // Length of each axis's parabola with its extrapolation, relative to that with one sample.
  [[nodiscard]] Lanes reach(std::size_t j) const noexcept {
    const double length = state_[j].length;
    return (length + since_) / (length + 1.0);
  }
  // Nominal samples since each axis was corrected; 1 if none is missing.
  [[nodiscard]] const Lanes& since() const noexcept { return since_; }
  // Distance of each axis's measurements of late, nominal samples: the trackers' noise is as many times larger.
  [[nodiscard]] const Lanes& stride() const noexcept { return stride_; }

 private:
  struct State {
    Lanes rate = Lanes::Zero(), slope = Lanes::Zero(),
          curvature = Lanes::Zero();  // per sample; half per sample^2
    double age = 0.0, length = 1.0;
    bool settled = false;
    Gains gains{};
  };

  void grow_to(State& state, std::size_t j, double age) const noexcept;
  void set_gains(State& state, std::size_t j) const noexcept;
  void prolong(State& state, double steps) const noexcept;
  void correct_some(State& state, const Lanes& rate, const Lanes& mask) noexcept;
  // True if every axis was corrected at the last nominal sample.
  [[nodiscard]] bool all_since_last() const noexcept { return (axes_ * (since_ - 1.0)).abs().sum() == 0.0; }
  // Axes that have been missing for longer than a parabola is extrapolated.
  [[nodiscard]] auto ended(const State& state) const noexcept { return since_ > kMostLengths * state.length; }

  // Largest extrapolation in units of the parabola's length: its squared error is then 3^6 times as large.
  static constexpr double kMostLengths = 2.0;
  Lanes axes_;  // 1 for the sensor's axes
  std::array<double, kMost> memory_{}, horizon_{};
  std::array<Gains, kMost> fading_{};
  std::array<State, kMost> state_{};
  std::size_t size_ = 0;
  Lanes since_ = Lanes::Zero(), stride_ = Lanes::Ones();
};

}  // namespace ifog
