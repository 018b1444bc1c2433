// SPDX-License-Identifier: Apache-2.0
// In a manoeuvre: which trackers, from the raw measurement to the longest, and how much of the filter at
// rest.
//
// The measure is the unbiased estimate of a linear filter's risk (Mallows' Cp; Stein, Annals of Statistics 9,
// 1981): the square of what it leaves of the measurement plus 2 R times its gain. It needs the known R and
// nothing of the motion. Motion that a tracker does not follow, be it broadband, raises the first term; so no
// mix is worse than the raw measurement by more than chance. Neighbours are compared along the chain over the
// shorter one's horizon, each axis by itself; the axis that moves most decides for all, as they share one
// gain.
#pragma once

#include <array>
#include <cstddef>

#include "filters/estimator/sample.h"
#include "filters/estimator/trackers.h"

namespace ifog {

class Mix {
 public:
  Mix() noexcept { begin(0); }
  struct Published {
    Lanes rate = Lanes::Zero(), variance = Lanes::Zero();
    double gain = 0.0;
  };

  // The filter at rest is wrong if it is behind by so many nats.
  static constexpr double kFailed = 6.0;

  // found: the tracker that predicts the motion.
  void begin(std::size_t found) noexcept;
  // The filter at rest has been right until now, and is left as soon as a measurement contradicts it.
  void begin_from_rest() noexcept {
    begin(0);
    rest_ratio_.setConstant(kFound);
  }
  // Corrects the trackers. coloured: 1 where R is above what third differences say.
  void take(Trackers& trackers, const Sample& now, const Lanes& colour) noexcept;
  // rest, rest_variance, lag: of the filter at rest; scale: R.
  [[nodiscard]] Published publish(const Trackers& trackers, const Lanes& rest, const Lanes& rest_variance,
                                  const Lanes& scale, double lag) const noexcept;
  // The filter at rest is surely wrong: it has to begin again from the mix.
  [[nodiscard]] bool rest_failed() const noexcept { return least(rest_ratio_) < -kFailed; }
  void begin_rest() noexcept;
  [[nodiscard]] bool rest_found() const noexcept;
  [[nodiscard]] double rest_weight() const noexcept { return rest_weight_; }
  // Samples that what is published looks back on.
  [[nodiscard]] double length(const Trackers& trackers, double lag) const noexcept;
  // What is published is nearly the raw rate: nothing follows the motion.
  [[nodiscard]] bool raw() const noexcept { return gain_ > kRawGain; }

 private:
  // Least over the axes measured; 0 before any is.
  [[nodiscard]] double least(const Lanes& lanes) const noexcept;
  static constexpr double kFound = 9.0;  // nats
  static constexpr double kRawGain = 0.7;

  std::array<Lanes, Trackers::kMost> link_{}, bias_{};
  std::array<double, Trackers::kMost> weight_{}, compared_{};
  Lanes rest_ratio_ = Lanes::Zero(), seen_ = Lanes::Zero();  // 1: the axis was measured in this manoeuvre
  double gain_ = 1.0;                                        // of the trackers' part
  double rest_age_ = 0.0, rest_weight_ = 0.0, failed_after_ = 0.0;
};

}  // namespace ifog
