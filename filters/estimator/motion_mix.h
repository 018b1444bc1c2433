// SPDX-License-Identifier: Apache-2.0
// What is published while the rate changes: the trackers' mean, each with the weight it has earned, and the
// filter at rest among them when it has.
//
// Trackers are judged in a chain: is a longer one as good as the one before it? By the log-likelihood ratio
// of the two over three memories of the shorter one, so that a choice between short trackers takes samples
// and one between long ones thousands. The weight of a tracker is that of all links up to it holding and the
// next one not. It is Lepski's way of finding a bandwidth (Theory of Probability and its Applications 35(3),
// 1991) with probabilities for decisions.
#pragma once

#include <array>

#include "filters/estimator/change_test.h"
#include "filters/estimator/tracker_bank.h"

namespace ifog {

class MotionMix {
 public:
  // failed_after: samples for which the filter at rest held before it did not; it is then not believed again
  // before it has held for three times as long.
  void begin(double failed_after) noexcept;

  // After trackers.predict(), before correct(): judges the predictions. least: per axis the least normalised
  // square of all trackers; what none of them foresaw speaks against none of them. colour: per axis, of its
  // noise, as it is known from rest; 1: white.
  void judge(const TrackerBank& trackers, const Surprise& now, const Axes& least,
             const Axes& colour) noexcept;
  // After everybody has taken the measurement in: the weights; and what two trackers differ by.
  void weigh(const TrackerBank& trackers) noexcept;
  void compare(const TrackerBank& trackers, const Surprise& now) noexcept;
  // The first tracker whose link has long been broken; size() when there is none.
  [[nodiscard]] std::size_t broken(const TrackerBank& trackers) noexcept;

  // The filter at rest is so wrong that it should begin again; begin_rest() says that it did.
  [[nodiscard]] bool rest_is_wrong() const noexcept;
  void begin_rest() noexcept;
  // Log-likelihood ratio of the filter at rest over the trackers' mean, since it began.
  [[nodiscard]] double rest_ratio() const noexcept { return rest_ratio_; }
  // It explains the measurements so well that the motion is over.
  [[nodiscard]] bool rest_is_right() const noexcept;

  [[nodiscard]] double rest_weight() const noexcept { return rest_weight_; }
  [[nodiscard]] double rate(const TrackerBank& trackers, std::size_t axis, double rest) const noexcept;
  // Variance of the mean, and the part of it that is no noise. Trackers share their noise: what two of them
  // have in common is the longer one's. A longer one has a bias in a motion it is too slow for: by as much it
  // is further from the next shorter one, on average over a while, than noise alone makes it.
  struct Doubt {
    double noise = 0.0, bias = 0.0, other = 0.0;
  };
  [[nodiscard]] Doubt doubt(const TrackerBank& trackers, std::size_t axis, double rest, double rest_variance,
                            double scale) const noexcept;
  [[nodiscard]] double gain(const TrackerBank& trackers, double rest_gain) const noexcept;
  // Samples that the mean has in it.
  [[nodiscard]] double length(const TrackerBank& trackers, double rest_gain) const noexcept;

 private:
  std::array<double, TrackerBank::kMost> weight_{}, link_{};
  // By axis and link: by how much the mean square of the two trackers' difference is above their noise's,
  // (rad/s)^2, and from how many measurements.
  std::array<std::array<double, TrackerBank::kMost>, kMaxAxes> bias_square_{};
  std::array<double, TrackerBank::kMost> compared_{};
  double rest_weight_ = 0.0, rest_ratio_ = 0.0;
  double rest_age_ = 0.0, failed_after_ = 0.0;
};

}  // namespace ifog
