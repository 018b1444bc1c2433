// Noise of a sensor learned while it rests, for a filter that was told none.
//
// What start_up.h does with a record this does with a stream: second differences of block means over octaves,
// of samples the estimator calls rest. Chapter by chapter the sums are compared: a chapter whose random walk
// is surely slower than the one known so far replaces all that was known, as a slow motion that passes for
// rest only ever makes the walk look quicker; one that is surely quicker is such a motion, and left out.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "filters/estimator/start_up.h"
#include "filters/settings/axes.h"

namespace ifog {

class RestNoise {
 public:
  // The next measurement of all axes; rests: it is one at rest and follows the one before without a gap.
  void take(const Axes& rate, std::uint32_t valid_axes, bool rests) noexcept;
  // What is known now, when that has changed: at the end of a chapter.
  std::optional<NoiseEstimate> take_news(double period_s) noexcept;

 private:
  static constexpr std::size_t kOctaves = 20;
  static constexpr int kChapter = 4096;  // samples at rest
  struct Octave {
    std::array<double, 2> means{};  // of the last two blocks
    double half = 0.0;              // mean of the first half of the block under way
    int blocks = 0;                 // whole ones since the series began, up to two
    bool has_half = false;
  };
  struct Sums {
    std::array<double, kOctaves> squares{}, counts{};
    double samples = 0.0;
  };

  void add(std::size_t axis, double rate) noexcept;
  void end_chapter() noexcept;
  [[nodiscard]] static double misfit(const Sums& sums, double ratio, double& noise) noexcept;
  [[nodiscard]] static double best_ratio(const Sums& sums) noexcept;

  std::array<std::array<Octave, kOctaves>, kMaxAxes> octaves_{};
  Sums known_, chapter_;
  int in_chapter_ = 0;
  bool news_ = false;
};

}  // namespace ifog
