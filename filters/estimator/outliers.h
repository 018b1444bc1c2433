// SPDX-License-Identifier: Apache-2.0
// Outlier test: a measurement that nothing predicts waits for the next ones, which may show a jump.
#pragma once

#include <algorithm>
#include <cmath>

#include "filters/estimator/sample.h"
#include "filters/estimator/trackers.h"
#include "filters/random/log_exp.h"

namespace ifog {

class Outliers {
 public:
  enum class Verdict { usual, waits, jump };

  // To be called before Trackers::correct(). allowed: factor on R, by axis; scattered: a jump's measurements
  // need not be close to each other; lag: of the filter at rest, samples.
  [[nodiscard]] Verdict take(const Trackers& trackers, const Sample& now, const Lanes& allowed, bool moving,
                             bool scattered, double lag) noexcept {
    // After a gap nothing predicts the measurement, in a manoeuvre after one missing sample.
    const double longest = moving ? static_cast<double>(run_) + 1.5 : kShortGap;
    if (greatest(now.mask * trackers.since()) > longest) {
      run_ = 0;
      return Verdict::usual;
    }
    Eigen::Index axis = 0;
    const bool at_rest = (now.surprise <= kMostSquare).all();  // the usual case
    const Lanes each = at_rest ? Lanes::Zero() : (least_surprise(trackers, now) / allowed).eval();
    const double least = each.maxCoeff(&axis);
    const Lanes& rate = now.rate;
    // Frequent outliers at rest may be shocks, whose angle counts.
    const double most = !moving && share_ > kRare ? kFarSquare : kMostSquare;
    if (least <= most) {
      if (!moving)
        share_ += ((least > kMostSquare ? 1.0 : 0.0) + static_cast<double>(run_) - share_) / kTailMemory;
      if (run_ > 0 && !moving) rejected_ += 1.0;
      run_ = 0;
      return Verdict::usual;
    }
    if (run_ == 0) {
      nearness_ = unlikely_ = 0.0;
      squares_ = least;
    } else {
      squares_ += least;
      const double apart = rate[axis] - last_[axis];
      nearness_ += 0.5 * logarithm(squares_ / static_cast<double>(run_ + 1) /
                                   std::max(2.0, apart * apart / now.scale[axis]));
    }
    last_ = rate;
    ++run_;
    // Where many seem to be outliers, they are a motion that begins.
    unlikely_ += static_cast<double>((each > most).count());
    const double evidence = unlikely_ * std::max(rarity(), -logarithm(kRare));
    const bool near = moving || scattered || nearness_ >= 0.5 * logarithm(lag);
    if (!(evidence > kEvidence && near && run_ > 1)) return Verdict::waits;
    jumps_ += 1.0;
    return Verdict::jump;
  }
  // Probability that a waiting measurement is an outlier and no jump, by those before it (Laplace's rule).
  [[nodiscard]] double chance() const noexcept { return (rejected_ + 1.0) / (rejected_ + jumps_ + 2.0); }
  // Evidence of one outlier at rest in nats. It is limited because two may coincide by chance.
  [[nodiscard]] double rarity() const noexcept { return std::min(kMostNats, -logarithm(share_ + 1e-6)); }
  void end_run() noexcept { run_ = 0; }

 private:
  // The smallest normalised square of an innovation of all filters.
  [[nodiscard]] static Lanes least_surprise(const Trackers& trackers, const Sample& now) noexcept {
    Lanes least = now.surprise;
    // The raw tracker, a parabola through three measurements, predicts no better.
    for (std::size_t j = 1; j < trackers.size(); ++j) {
      if (!trackers.predicts(j)) return Lanes::Zero();
      const Lanes error = now.rate - trackers.rate(j);
      least = least.min(error * error * now.inverse / trackers.factor(j));
    }
    return least;
  }

  // Share of all measurements: two within the memory are frequent. Clipping so many costs the filter at rest 0.3 %
  // of its variance; rejecting them on one side only would bias it. Two in succession exceed kEvidence.
  static constexpr double kRare = 1.0 / kTailMemory;

  Lanes last_ = Lanes::Zero();  // of the run
  double share_ = 0.0, nearness_ = 0.0, squares_ = 0.0, unlikely_ = 0.0, rejected_ = 0.0, jumps_ = 0.0;
  std::size_t run_ = 0;
};

}  // namespace ifog
