// SPDX-License-Identifier: Apache-2.0
// How quick a walk the record leaves possible, by its likelihood.
//
// Octaves (octave_fit.h) see a slow walk late: a second difference of three blocks knows nothing of what
// comes out of their mean and their slope. The likelihood of the record has it all: of each walk on a grid a
// Kalman filter runs over means of blocks, and its innovations say how likely it is, R left open. Noise has
// to be white from block to block, and the walk slow beside a block. Where it is not, the walk only looks
// quicker, so that of two bounds the slower one holds.
//
// A block is worked in while the next one is read, one trial a sample.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <utility>

#include "filters/random/log_exp.h"
#include "filters/settings/axes.h"

namespace ifog {

class WalkLikelihood {
 public:
  WalkLikelihood() noexcept {
    double ratio = kSlowest;
    for (double& tried : ratios_) tried = std::exchange(ratio, kStep * ratio);
  }

  void take(std::size_t axis, double rate) noexcept {
    Axis& of = axes_[axis];
    go_on(of);
    of.sum += rate;
    if (++of.samples < kBlock) return;
    of.mean = of.sum / kBlock;
    of.sum = 0.0;
    of.samples = 0;
    of.next = 0;
  }
  // What comes next goes on from nothing before.
  void break_off(std::size_t axis) noexcept {
    Axis& of = axes_[axis];
    of.sum = 0.0;
    of.samples = 0;
    of.broken_off = true;
    go_on(of);
  }

  // What was taken since the last call is set aside, to be believed or not.
  void set_aside() noexcept { aside_ = std::exchange(lately_, {}); }
  void believe() noexcept {
    for (std::size_t k = 0; k < kTrials; ++k) {
      known_.squares[k] += aside_.squares[k];
      known_.logs[k] += aside_.logs[k];
    }
    known_.count += aside_.count;
  }
  void forget() noexcept { known_ = {}; }
  // What was set aside and taken since is not to be believed.
  void drop() noexcept {
    aside_ = lately_ = {};
    for (Axis& axis : axes_) axis = {};
  }

  // Quickest walk, driving noise of a sample over R, that is nearly as likely as the likeliest: by so much of
  // -2 log-likelihood. Infinite: not known.
  [[nodiscard]] double quickest(double nearly) const noexcept {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    if (known_.count < kFewest) return kNone;
    double best = kNone, found = kNone;
    for (std::size_t k = 0; k < kTrials; ++k) {
      if (!(known_.squares[k] > 0.0)) return kNone;
      const double misfit = known_.count * logarithm(known_.squares[k]) + known_.logs[k];
      best = std::min(best, misfit);
      if (misfit <= best + nearly) found = ratios_[k];
    }
    return found < kQuickest ? found : kNone;
  }

 private:
  static constexpr int kBlock = 64;  // samples
  static constexpr std::size_t kTrials = 48;
  static constexpr double kSlowest = 1e-12, kStep = 1.5;
  // A lag of four blocks.
  static constexpr double kQuickest = 1.0 / (16.0 * kBlock * kBlock);
  static constexpr double kFewest = 16.0;

  struct Level {
    double value = 0.0, variance = -1.0;  // in that of a block's noise; below 0: not known
  };
  struct Axis {
    double sum = 0.0, mean = 0.0;
    int samples = 0;
    std::size_t next = kTrials;  // trial that the mean is to be worked into
    bool broken_off = false;     // after that
    std::array<Level, kTrials> levels{};
  };
  struct Sums {
    std::array<double, kTrials> squares{}, logs{};
    double count = 0.0;
  };

  void go_on(Axis& of) noexcept {
    if (of.next < kTrials) return work_in(of, of.next++);
    if (std::exchange(of.broken_off, false)) of.levels = {};
  }

  void work_in(Axis& of, std::size_t k) noexcept {
    Level& level = of.levels[k];
    if (level.variance < 0.0) {
      level = {of.mean, 1.0};
      return;
    }
    const double variance = level.variance + ratios_[k] * kBlock * kBlock, factor = 1.0 + variance;
    const double innovation = of.mean - level.value;
    lately_.squares[k] += innovation * innovation / factor;
    lately_.logs[k] += logarithm(factor);
    if (k == 0) lately_.count += 1.0;
    level.variance = variance / factor;
    level.value += level.variance * innovation;
  }

  std::array<double, kTrials> ratios_{};
  std::array<Axis, kMaxAxes> axes_{};
  Sums lately_, aside_, known_;
};

}  // namespace ifog
