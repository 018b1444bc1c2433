// SPDX-License-Identifier: Apache-2.0
// Tests that look at a sensor for ever and may cry wolf once in a given time, on figures of blocks of its
// samples at rest. Nothing here is a real-time thread's.
//
// With a false alarm every `blocks` blocks on average:
//
// - CUSUM of a log likelihood ratio (E. S. Page, Biometrika 41, 1954): above h = ln(blocks), the time to a
// false
//   alarm is `blocks` or more, whatever the law, as long as the ratio is one (G. Lorden, Ann. Math. Statist.
//   42, 1971). Where what holds is further from the alternative than the law that the ratio has, it is
//   longer.
//
// - The greatest |z| of all windows of 1 … w blocks of a Gaussian white series: D. Siegmund and E. S.
//   Venkatraman, Ann. Statist. 23 (1995), give for a threshold c
//
//     blocks = sqrt(2 pi) exp(c^2 / 2) / (c I),   I = integral of x nu(x)^2 dx from c / sqrt(w) to c,
//
//   nu(x) = exp(-0.583 x) close enough. Windows whose weights fade are fewer that differ, and alarm no more
//   often.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace ifog {

// The threshold c above. blocks > 100; windows >= 1.
[[nodiscard]] double window_threshold(double blocks, std::size_t windows);
// Likewise what it gives: the mean time to a false alarm, in blocks.
[[nodiscard]] double window_blocks(double threshold, std::size_t windows);

// Whether a state that is rare has become usual: blocks are odd with probability 0.01 at most before, 0.9
// after.
class UsualCusum {
 public:
  explicit UsualCusum(double threshold) : threshold_(threshold) {}
  void take(bool odd) noexcept;
  // Once beyond the threshold, until it is back at zero.
  [[nodiscard]] bool alarmed() const noexcept { return alarmed_; }
  void restart() noexcept {
    sum_ = 0.0;
    alarmed_ = false;
  }

 private:
  double threshold_, sum_ = 0.0;
  bool alarmed_ = false;
};

// Whether a white series of variance 1 has come to follow its own last value by `kFollows`.
class ColourCusum {
 public:
  static constexpr double kFollows = 0.6;
  explicit ColourCusum(double threshold) : threshold_(threshold) {}
  void take(double value) noexcept;
  void break_off() noexcept { known_ = false; }
  [[nodiscard]] bool alarmed() const noexcept { return alarmed_; }
  void restart() noexcept {
    sum_ = 0.0;
    alarmed_ = known_ = false;
  }

 private:
  double threshold_, sum_ = 0.0, last_ = 0.0;
  bool known_ = false, alarmed_ = false;
};

// What a level that steps leaves in the innovations of the filter that follows it: they are off by the step,
// and from block to block by less, as the filter takes its gain of it. Each block of the last `kWindows` may
// have been the first.
//
// Real innovations are not quite white: the sums of a window vary by what they have been seen to, for each
// length of window, two standard errors added; never by less than those of white ones.
class StepTest {
 public:
  static constexpr std::size_t kWindows = 60;
  explicit StepTest(double threshold) : threshold_(threshold) {}
  // innovation: of variance 1. gain: of the filter, at this block. spread: the innovation's standard
  // deviation, in the unit that step() has. True: a step is found, and the test begins anew.
  bool take(double innovation, double gain, double spread) noexcept;
  [[nodiscard]] double step() const noexcept { return step_; }
  [[nodiscard]] double threshold() const noexcept { return threshold_; }
  // The largest |z| since restart().
  [[nodiscard]] double largest() const noexcept { return largest_; }
  // What begins now has nothing to do with what came; what sums vary by stays known.
  void restart() noexcept;

 private:
  struct Window {
    double weight = 1.0, sum = 0.0, squares = 0.0;
    std::size_t blocks = 0;
  };
  // Of the sums of windows of one length, over their variance if the innovations were white.
  struct Spread {
    double mean_square = 1.0, count = 0.0;
  };
  [[nodiscard]] double variance(std::size_t blocks) const noexcept;
  double threshold_, step_ = 0.0, largest_ = 0.0;
  std::array<Window, kWindows> windows_{};
  std::array<Spread, kWindows> spreads_{};  // by length less one
  std::size_t begun_ = 0;                   // in all
};

// The level of block means as a random walk in white noise, the ratio of the two by maximum likelihood over
// all that has come: a filter for each ratio of a table.
class LevelNoise {
 public:
  LevelNoise();
  struct Innovation {
    bool known = false;
    double value = 0.0, spread = 0.0, gain = 0.0;  // value: of variance 1
  };
  // The next mean, `blocks` after the one before (1: its neighbour).
  Innovation take(double mean, double blocks) noexcept;
  // The level is anybody's guess from here on; what is known of the noise stays.
  void forget_level() noexcept { has_level_ = false; }
  [[nodiscard]] double level() const noexcept;
  [[nodiscard]] double blocks() const noexcept { return count_; }

 private:
  static constexpr std::size_t kRatios = 17;  // 1e-7 … 10, half decades
  struct Filter {
    double ratio = 0.0, level = 0.0, variance = 0.0, squares = 0.0, log_variance = 0.0;
  };
  void choose() noexcept;
  std::array<Filter, kRatios> filters_{};
  std::size_t chosen_ = 0;
  double count_ = 0.0;
  bool has_level_ = false;
};

}  // namespace ifog
