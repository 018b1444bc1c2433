// SPDX-License-Identifier: Apache-2.0
// Outliers: a measurement that neither the filter at rest nor any tracker predicts waits for the next ones.
//
// So many in a row that chance does not explain them, outliers being as rare as they have been, are a jump.
// Where outliers are frequent the measurements of a jump also have to be nearer to each other than those of
// noise.
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

  // allowed: by which R may be exceeded, by axis; scattered: measurements may be a jump that are no nearer to each other
  // than to the old rate; lag: of the filter at rest, samples. Before Trackers::correct().
  [[nodiscard]] Verdict take(const Trackers& trackers, const Sample& now, const Lanes& allowed, bool moving,
                             bool scattered, double lag) noexcept {
    // Behind a gap nothing predicts.
    if (greatest(now.mask * trackers.since()) > kShortGap) {
      run_ = 0;
      return Verdict::usual;
    }
    Eigen::Index axis = 0;
    const bool at_rest = (now.surprise <= kMostSquare).all();  // nearly always
    const double least = at_rest ? 0.0 : (least_surprise(trackers, now) / allowed).maxCoeff(&axis);
    const Lanes& rate = now.rate;
    seen_ = std::min(seen_ + 1.0, kTailMemory);
    // Where they are frequent at rest they may be blows, whose angle counts.
    const double most = !moving && share_ > kRare ? kFarSquare : kMostSquare;
    if (least <= most) {
      // A run lasts until its own axis is measured again, if that is soon.
      if (run_ > 0 && (now.valid >> axis_ & 1U) == 0 && ++waited_ < kShortGap) return Verdict::usual;
      if (!moving) share_ += ((least > kMostSquare ? 1.0 : 0.0) + static_cast<double>(run_) - share_) / seen_;
      run_ = 0;
      return Verdict::usual;
    }
    if (run_ == 0) {
      nearness_ = 0.0;
      squares_ = least;
    } else {
      squares_ += least;
      const double apart = rate[axis] - last_[axis];
      nearness_ += 0.5 * logarithm(squares_ / static_cast<double>(run_ + 1) /
                                   std::max(2.0, apart * apart / now.scale[axis]));
    }
    last_ = rate;
    axis_ = axis;
    waited_ = 0;
    ++run_;
    // Twice the evidence is no noise's that is known, however far apart they are.
    const double evidence = static_cast<double>(run_) * rarity();
    const bool near =
        moving || nearness_ >= 0.5 * logarithm(lag) || (scattered && evidence > 2.0 * kEvidence);
    return evidence > kEvidence && near ? Verdict::jump : Verdict::waits;
  }
  // Nats by which an outlier at rest is rare: it counts for no more, as two come together by chance.
  [[nodiscard]] double rarity() const noexcept { return std::min(kMostNats, -logarithm(share_ + 1e-6)); }
  [[nodiscard]] std::size_t run() const noexcept { return run_; }
  void end_run() noexcept { run_ = 0; }

 private:
  // The smallest square of an innovation over its variance that any filter has.
  [[nodiscard]] static Lanes least_surprise(const Trackers& trackers, const Sample& now) noexcept {
    Lanes least = now.surprise;
    // The raw one, a parabola through three measurements, predicts nothing better than others.
    for (std::size_t j = 1; j < trackers.size(); ++j) {
      if (!trackers.predicts(j)) return Lanes::Zero();
      const Lanes error = now.rate - trackers.rate(j);
      least = least.min(error * error * now.inverse / trackers.factor(j));
    }
    return least;
  }

  // Share of all measurements. So many, taken in clipped, cost the filter at rest half a per cent of its variance; left
  // out on one side only they would put its rate off.
  static constexpr double kRare = 2e-4;

  Lanes last_ = Lanes::Zero();  // of the run
  double seen_ = 0.0, share_ = 0.0, nearness_ = 0.0, squares_ = 0.0;
  std::size_t run_ = 0;
  int waited_ = 0;         // samples of other axes since
  Eigen::Index axis_ = 0;  // of the run's last measurement
};

}  // namespace ifog
