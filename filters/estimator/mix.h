// SPDX-License-Identifier: Apache-2.0
// Mixture in a manoeuvre: weights of the trackers, from the raw measurement to the longest, and of the filter
// at rest, by the unbiased estimate of their risk (Mallows' Cp; Stein, Annals of Statistics 9, 1981).
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

  // Evidence in nats at which the filter at rest is wrong.
  static constexpr double kFailed = 6.0;

  // found: tracker that predicts the motion.
  void begin(std::size_t found) noexcept;
  // Starts with the filter at rest, which is left as soon as a measurement contradicts it.
  void begin_from_rest() noexcept {
    begin(0);
    rest_ratio_.setConstant(kFound);
  }
  // Corrects the trackers. coloured: 1 for axes whose R is above that of third differences.
  // rest: corrected rate of the filter at rest; common: covariance of its error and the noise of `now`, over R.
  void take(Trackers& trackers, const Sample& now, const Lanes& colour, const Lanes& rest,
            double common) noexcept;
  // rest, rest_variance, lag: of the filter at rest; scale: R.
  [[nodiscard]] Published publish(const Trackers& trackers, const Lanes& rest, const Lanes& rest_variance,
                                  const Lanes& scale, double lag) const noexcept;
  // True if the filter at rest is certainly wrong and must restart from the mixture.
  [[nodiscard]] bool rest_failed() const noexcept { return least(rest_ratio_) < -kFailed; }
  void begin_rest() noexcept;
  [[nodiscard]] bool rest_found() const noexcept;
  [[nodiscard]] double rest_weight() const noexcept { return rest_weight_; }
  // Effective memory of the published rate, samples.
  [[nodiscard]] double length(const Trackers& trackers, double lag) const noexcept;
  // True if no tracker follows the motion, almost only the raw one. Equal samples in a motion, such as a
  // logger's repeats, are soon the filter's at rest.
  [[nodiscard]] bool raw() const noexcept { return gain_ > kRawGain * (1.0 - rest_weight_); }

 private:
  void predict(const Trackers& trackers, const Lanes& scale, Lanes& moving, Lanes& variance) const noexcept;
  // Minimum over the measured axes; 0 before the first measurement.
  [[nodiscard]] double least(const Lanes& lanes) const noexcept;
  static constexpr double kFound = 9.0;  // nats
  static constexpr double kRawGain = 0.7;

  std::array<Lanes, Trackers::kMost> link_{}, bias_{};
  // Mean squares of the trackers' prediction errors and of that of holding the last measurement.
  std::array<Lanes, Trackers::kMost> ahead_{};
  Lanes held_ = Lanes::Zero(), last_ = Lanes::Zero();
  std::array<double, Trackers::kMost> weight_{}, compared_{};
  Lanes rest_ratio_ = Lanes::Zero(), seen_ = Lanes::Zero();  // 1 if the axis was measured in this manoeuvre
  double gain_ = 1.0;                                        // of the trackers' part
  double age_ = 0.0;                                         // measurements, at most kShortGap
  double rest_age_ = 0.0, rest_weight_ = 0.0, failed_after_ = 0.0;
};

}  // namespace ifog
