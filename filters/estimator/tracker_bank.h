// SPDX-License-Identifier: Apache-2.0
// Trackers of rate, slope and curvature that forget at different speeds: from the last three samples to as
// long as the filter at rest, half a power of ten apart.
//
// A tracker is the fading-memory polynomial filter of second degree (Morrison, "Introduction to Sequential
// Smoothing and Prediction", 1969; Brookner, "Tracking and Kalman Filtering Made Easy", 1998, section 7):
// three equal poles at theta, gains 1 - theta^3, 3/2 (1 - theta)^2 (1 + theta), (1 - theta)^3. Of rate to
// output, 1 - H is the cube of a first difference: no lag on a constant slope or curvature, and a gain that
// departs from one only with the fourth power of frequency. That, not noise, is why the degree is two: the
// coning integral sees the square of the gain. Young, a tracker is the least-squares parabola through all
// measurements since it began.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "filters/estimator/lanes.h"
#include "filters/settings/axes.h"

namespace ifog {

class TrackerBank {
 public:
  static constexpr std::size_t kMost = 12;
  // Measurements that a parabola goes through: from then on a tracker foresees something.
  static constexpr double kParabola = 3.0;

  // axes: of the sensor, the first ones.
  explicit TrackerBank(std::size_t axes = kMaxAxes);

  // Trackers as long as this, in samples, take part; once in they stay.
  void reach(double samples) noexcept;
  void begin() noexcept;
  // All of them afresh from these measurements, oldest first.
  void begin(std::span<const Axes> measurements) noexcept;
  // This one, and all that are longer, from what the one before it knows.
  void begin_from(std::size_t tracker, std::size_t from) noexcept;

  // One step of so many nominal samples.
  void predict(double steps) noexcept;
  void correct(const Axes& rate, std::uint32_t valid_axes) noexcept;
  // The measurement is not to be believed: nothing but time passes, and slopes fade, as what they point to
  // grows.
  void pass_over() noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  // After predict() the rate one sample ahead, after correct() the filtered one.
  [[nodiscard]] double rate(std::size_t tracker, std::size_t axis) const noexcept {
    return state_[tracker].rate[static_cast<Eigen::Index>(axis)];
  }
  [[nodiscard]] const Lanes& rates(std::size_t tracker) const noexcept { return state_[tracker].rate; }
  // Innovation variance over that of the noise, and its logarithm; output variance likewise.
  [[nodiscard]] double factor(std::size_t tracker) const noexcept { return now_[tracker].innovation; }
  [[nodiscard]] double log_factor(std::size_t tracker) const noexcept { return now_[tracker].log_innovation; }
  [[nodiscard]] double output_factor(std::size_t tracker) const noexcept { return now_[tracker].output; }
  [[nodiscard]] double gain(std::size_t tracker) const noexcept { return now_[tracker].rate; }
  // Variance of what it foresees of an axis that was last corrected `since(axis)` samples ago, over that of
  // one sample ahead.
  [[nodiscard]] double growth(std::size_t tracker, std::size_t axis) const noexcept;
  // Whether the axis has been missing for no longer than the tracker prolongs what it has; and where it has,
  // the variance of the rate that is held instead, by how steep it has lately been.
  [[nodiscard]] bool foresees(std::size_t tracker, std::size_t axis) const noexcept {
    return state_[tracker].age >= kParabola && since(axis) <= farthest(tracker, axis);
  }
  [[nodiscard]] double drift_square(std::size_t tracker, std::size_t axis) const noexcept {
    return since(axis) * since(axis) * state_[tracker].slope_square[static_cast<Eigen::Index>(axis)];
  }
  [[nodiscard]] double since(std::size_t axis) const noexcept {
    return steps_[static_cast<Eigen::Index>(axis)];
  }
  [[nodiscard]] double factor(std::size_t tracker, std::size_t axis) const noexcept {
    const double one = now_[tracker].innovation;
    return since(axis) == 1.0 ? one : 1.0 + (one - 1.0) * growth(tracker, axis);
  }
  // Samples it forgets in, and what it has of them by now.
  [[nodiscard]] double memory(std::size_t tracker) const noexcept { return memory_[tracker]; }
  [[nodiscard]] double length(std::size_t tracker) const noexcept { return state_[tracker].length; }
  [[nodiscard]] double age(std::size_t tracker) const noexcept { return state_[tracker].age; }

 private:
  struct Gains {
    double rate = 0.0, slope = 0.0, curvature = 0.0;
    double innovation = 1.0, log_innovation = 0.0, output = 1.0;
  };
  struct State {
    Lanes rate = Lanes::Zero(), slope = Lanes::Zero(), curvature = Lanes::Zero();  // per sample, half of it
                                                                                   // per sample squared
    Lanes filtered = Lanes::Zero();      // the rate when it was last corrected
    Lanes slope_square = Lanes::Zero();  // mean over its last lengths
    Lanes usual_step = Lanes::Ones();    // mean distance of its measurements, nominal samples
    double age = 0.0;                    // measurements of all axes
    double length = 1.0;                 // what it has of its memory by now, samples
    bool settled = false;
    bool even = true;  // all of its measurements have come a nominal sample apart
  };

  void gains(std::size_t tracker) noexcept;
  void grow_to(std::size_t tracker, double age) noexcept;
  // Nominal samples that it is prolonged by.
  [[nodiscard]] double farthest(std::size_t tracker, std::size_t axis) const noexcept;
  [[nodiscard]] bool too_far(const State& state) const noexcept;
  void prolong_some(std::size_t tracker, double steps) noexcept;
  void correct_all(std::size_t tracker, const Lanes& rate, bool even) noexcept;
  void correct_some(std::size_t tracker, const Axes& rate, std::uint32_t valid_axes) noexcept;

  std::size_t axes_;
  std::array<double, kMost> memory_{};
  std::array<Gains, kMost> fading_{}, now_{};
  std::array<State, kMost> state_{};
  std::size_t size_ = 0;
  // Since each axis was corrected, nominal samples. The gains are those of one step, whatever its length: in
  // units of nominal samples those of slope and curvature fall with it. Left as they are, steps of two and
  // more would put the poles outside the unit circle; and so would those of a short step among long ones,
  // for which the mean step counts.
  Lanes steps_ = Lanes::Zero();
  // Axes that were corrected since the trackers began. These grow older with a sample that has all of them,
  // but those gone for long: with gains for more measurements than an axis has had its parabola would be off
  // for long. Of axes that never come together they stay young.
  std::uint32_t measured_ = 0;
};

}  // namespace ifog
