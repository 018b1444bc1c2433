// SPDX-License-Identifier: Apache-2.0
// Noise of a sensor learned while it rests, for a filter that was told none.
//
// What start_up.h does with a record this does with a stream: second differences of block means over octaves,
// of samples the estimator calls rest. Chapter by chapter the sums are compared: a chapter whose random walk
// is surely slower than the likeliest so far replaces all that was known, as a slow motion that passes for
// rest only ever makes the walk look quicker; one that is surely quicker than the bound so far is such a
// motion, and left out.
// Blocks that reach back into what was replaced or left out have that in them: they begin anew, and a chapter
// replaces by the blocks that are all its own.
//
// What an earlier run of the daemon has learned is a beginning: should the first chapters all be surely
// quicker, it was of another sensor, or of this one when it was younger, and is forgotten. Learned with other
// corrections it is none of this noise's sums, as a walk that is corrected now would stay in them for as long
// as it was there. Its ratio of walk to noise is a bound then, until the chapters have surely more.
//
// The first chapters are short, each twice as long as the one before: a few hundred samples bound the walk
// better than a start-up does that had fewer.
//
// A chapter is judged while the next one is read, one trial of the random walk a sample, so that no step
// takes longer than another by more than the logarithms of the octaves.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "filters/estimator/learned_noise.h"
#include "filters/estimator/start_up.h"
#include "filters/estimator/walk_likelihood.h"
#include "filters/settings/axes.h"

namespace ifog {

// What a measurement is to the noise: of rest; passed over, of neither; or of a motion, after which all
// begins anew.
enum class RestSample { kRest, kPassedOver, kMotion };

class RestNoise {
 public:
  // Before the first take(): what an earlier run has learned.
  void recall(const OctaveSums& known) noexcept;
  // Likewise, of the same sensor corrected otherwise.
  void recall_bound(const OctaveSums& of_other) noexcept;
  // Or what was known before is of a start-up of so many samples: the first chapter is as long.
  void begin_after(std::size_t samples) noexcept;
  // The next measurement of all axes. A gap before it is motion.
  void take(const Axes& rate, std::uint32_t valid_axes, RestSample is) noexcept;
  // What is known now, once, when that has changed.
  std::optional<NoiseEstimate> take_news(double period_s) noexcept;
  [[nodiscard]] const OctaveSums& known() const noexcept { return known_; }
  // As long as a chapter at least: worth more than what was a bound.
  [[nodiscard]] bool knows_enough() const noexcept { return known_.samples >= kChapter; }

 private:
  static constexpr std::size_t kOctaves = OctaveSums::kOctaves;
  static constexpr int kShortest = 256, kChapter = 4096;  // samples at rest
  // So many chapters in a row, a quarter of a million samples, contradict what was recalled.
  static constexpr int kContradicted = 64;
  static constexpr double kNoBound = std::numeric_limits<double>::infinity();
  struct Octave {
    std::array<double, 2> means{};  // of the last two blocks
    double half = 0.0;              // mean of the first half of the block under way
    int blocks = 0;                 // whole ones since the series began, up to two
    int own = -1;                   // of the chapter's own, up to two; the first one may reach back
    bool has_half = false;
  };
  // The ratio of walk to noise that fits best, looked for one trial a call.
  class RatioSearch {
   public:
    void begin(const OctaveSums& sums) noexcept;
    // True: at its end.
    bool advance(const OctaveSums& sums) noexcept;
    [[nodiscard]] double ratio() const noexcept { return best_; }
    [[nodiscard]] double quickest() const noexcept { return quickest_; }  // kNearlyAsWell
    [[nodiscard]] double misfit() const noexcept { return lowest_; }

   private:
    double next_ = 0.0, best_ = 0.0, quickest_ = 0.0, lowest_ = 0.0;
  };
  enum class Judging { kNothing, kChapter, kAll, kBound };

  void begin_chapter() noexcept;
  void add(std::size_t axis, double rate) noexcept;
  void judge() noexcept;
  void compare() noexcept;
  void judge_all() noexcept;

  std::array<std::array<Octave, kOctaves>, kMaxAxes> octaves_{};
  OctaveSums known_, chapter_, judged_;
  OctaveSums chapter_own_, judged_own_;
  WalkLikelihood likelihood_;
  RatioSearch search_;
  Judging judging_ = Judging::kNothing;
  double known_ratio_ = 0.0, likeliest_ = 0.0;
  double most_ratio_ = kNoBound;  // with other corrections
  int in_chapter_ = 0, chapter_length_ = kShortest;
  int contradictions_ =
      -1;  // chapters in a row against what was recalled; -1: it was confirmed, or nothing was
  bool news_ = false;
};

}  // namespace ifog
