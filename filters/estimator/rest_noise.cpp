#include "filters/estimator/rest_noise.h"

#include <algorithm>
#include <cmath>

#include "filters/random/log_exp.h"

namespace ifog {
namespace {

// Log-likelihood ratio by which two chapters surely differ.
constexpr double kSurely = 6.0;
// Second differences that overlap by two thirds count for half of their number.
constexpr double kIndependent = 0.5;

}  // namespace

void RestNoise::take(const Axes& rate, std::uint32_t valid_axes, bool rests) noexcept {
  for (std::size_t a = 0; a < kMaxAxes; ++a) {
    if (rests && (valid_axes >> a & 1U) != 0 && std::isfinite(rate[a])) {
      add(a, rate[a]);
    } else if (!rests) {
      // Blocks under way have motion in them.
      octaves_[a] = {};
    }
  }
  if (!rests || valid_axes == 0) return;
  chapter_.samples += 1.0;
  if (++in_chapter_ == kChapter) end_chapter();
}

void RestNoise::add(std::size_t axis, double rate) noexcept {
  double mean = rate;
  for (std::size_t k = 0; k < kOctaves; ++k) {
    Octave& octave = octaves_[axis][k];
    if (octave.blocks == 2) {
      const double second = mean - 2.0 * octave.means[1] + octave.means[0];
      chapter_.squares[k] += kIndependent * second * second;
      chapter_.counts[k] += kIndependent;
    } else {
      ++octave.blocks;
    }
    octave.means = {octave.means[1], mean};
    octave.has_half = !octave.has_half;
    if (octave.has_half) {
      octave.half = mean;
      return;
    }
    mean = 0.5 * (octave.half + mean);
  }
}

// Sum of n (ln S + V / S), S = R (6 / m + ratio m), at the R that fits best, which comes with it.
double RestNoise::misfit(const Sums& sums, double ratio, double& noise) noexcept {
  double weighted = 0.0, total = 0.0, logs = 0.0, block = 1.0;
  for (std::size_t k = 0; k < kOctaves; ++k, block *= 2.0) {
    if (!(sums.counts[k] > 0.0)) continue;
    const double shape = 6.0 / block + ratio * block;
    weighted += sums.squares[k] / shape;
    total += sums.counts[k];
    logs += sums.counts[k] * logarithm(shape);
  }
  noise = total > 0.0 ? weighted / total : 0.0;
  return noise > 0.0 ? total * logarithm(noise) + logs : 0.0;
}

double RestNoise::best_ratio(const Sums& sums) noexcept {
  // No slower than the record could have shown.
  const double least = 1.0 / (sums.samples * sums.samples);
  constexpr double kStep = 1.2;
  double best = least, lowest = 1e300, noise = 0.0;
  for (double ratio = least; ratio < 10.0; ratio *= kStep) {
    const double here = misfit(sums, ratio, noise);
    if (here < lowest) {
      lowest = here;
      best = ratio;
    }
  }
  return best;
}

void RestNoise::end_chapter() noexcept {
  in_chapter_ = 0;
  news_ = true;
  double noise = 0.0;
  if (known_.samples > 0.0) {
    const double known = best_ratio(known_), here = best_ratio(chapter_);
    const bool differ = 0.5 * (misfit(chapter_, known, noise) - misfit(chapter_, here, noise)) > kSurely;
    if (differ && here > known) {
      news_ = false;
      chapter_ = {};
      return;
    }
    if (differ) known_ = {};
  }
  for (std::size_t k = 0; k < kOctaves; ++k) {
    known_.squares[k] += chapter_.squares[k];
    known_.counts[k] += chapter_.counts[k];
  }
  known_.samples += chapter_.samples;
  chapter_ = {};
}

std::optional<NoiseEstimate> RestNoise::take_news(double period_s) noexcept {
  if (!news_) return std::nullopt;
  news_ = false;
  double noise = 0.0;
  const double ratio = best_ratio(known_);
  (void)misfit(known_, ratio, noise);
  if (!(noise > 0.0)) return std::nullopt;
  return NoiseEstimate{ratio * noise / period_s, noise};
}

}  // namespace ifog
