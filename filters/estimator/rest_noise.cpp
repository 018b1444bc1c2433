// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/rest_noise.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "filters/estimator/octave_fit.h"

namespace ifog {
namespace {

// Log-likelihood ratio by which two chapters surely differ.
constexpr double kSurely = 6.0;
// Second differences that overlap by two thirds count for half of their number.
constexpr double kIndependent = 0.5;
// Trials of the ratio of walk to noise: a factor apart, up to a walk that is all there is.
constexpr double kStep = 1.2;
constexpr double kMostNoiseRatio = 10.0;
// Of ratios that fit nearly as well as the best, a standard error wide, the quickest walk is taken: a filter
// that is a little too quick is a little louder, one that is too slow takes the walk for motion, and finds no
// rest to learn better from.
constexpr double kNearlyAsWell = 1.0;

}  // namespace

void RestNoise::RatioSearch::begin(const OctaveSums& sums) noexcept {
  // No slower than the record could have shown.
  next_ = best_ = quickest_ = 1.0 / (sums.samples * sums.samples);
  lowest_ = 1e300;
}

bool RestNoise::RatioSearch::advance(const OctaveSums& sums) noexcept {
  const double here = fit_octaves(sums.squares, sums.counts, next_).misfit;
  if (here < lowest_) {
    lowest_ = here;
    best_ = next_;
  }
  if (here <= lowest_ + kNearlyAsWell) quickest_ = next_;
  next_ *= kStep;
  return !(next_ < kMostNoiseRatio);
}

void RestNoise::recall(const OctaveSums& known) noexcept {
  if (!(known.samples > 0.0)) return;
  known_ = known;
  contradictions_ = 0;
  chapter_length_ = kChapter;
  // Its ratio first of all: no chapter is there to be compared before.
  search_.begin(known_);
  judging_ = Judging::kAll;
}

void RestNoise::recall_bound(const OctaveSums& of_other) noexcept {
  if (!(of_other.samples > 0.0)) return;
  judged_ = of_other;
  contradictions_ = 0;
  // No chapter ends before its ratio is found.
  chapter_length_ = 2 * kShortest;
  search_.begin(judged_);
  judging_ = Judging::kBound;
}

void RestNoise::begin_after(std::size_t samples) noexcept {
  chapter_length_ = static_cast<int>(std::clamp<std::size_t>(samples, kShortest, kChapter));
}

void RestNoise::take(const Axes& rate, std::uint32_t valid_axes, RestSample is) noexcept {
  if (judging_ != Judging::kNothing) judge();
  if (is == RestSample::kPassedOver) return;
  for (std::size_t a = 0; a < kMaxAxes; ++a) {
    // Blocks under way have motion in them.
    if (is == RestSample::kMotion) {
      octaves_[a] = {};
      likelihood_.break_off(a);
    }
    if (is == RestSample::kRest && (valid_axes >> a & 1U) != 0 && std::isfinite(rate[a])) add(a, rate[a]);
  }
  if (is == RestSample::kMotion || valid_axes == 0) return;
  chapter_.samples += 1.0;
  if (++in_chapter_ < chapter_length_) return;
  chapter_length_ = std::min(2 * chapter_length_, kChapter);
  judged_ = chapter_;
  judged_own_ = chapter_own_;
  judged_own_.samples = judged_.samples;
  likelihood_.set_aside();
  begin_chapter();
  search_.begin(judged_);
  judging_ = Judging::kChapter;
}

void RestNoise::begin_chapter() noexcept {
  in_chapter_ = 0;
  chapter_ = chapter_own_ = {};
  for (auto& axis : octaves_)
    for (Octave& octave : axis) octave.own = -1;
}

void RestNoise::add(std::size_t axis, double rate) noexcept {
  likelihood_.take(axis, rate);
  double mean = rate;
  for (std::size_t k = 0; k < kOctaves; ++k) {
    Octave& octave = octaves_[axis][k];
    if (octave.blocks == 2) {
      const double second = mean - 2.0 * octave.means[1] + octave.means[0];
      chapter_.squares[k] += kIndependent * second * second;
      chapter_.counts[k] += kIndependent;
      if (octave.own == 2) {
        chapter_own_.squares[k] += kIndependent * second * second;
        chapter_own_.counts[k] += kIndependent;
      }
    } else {
      ++octave.blocks;
    }
    octave.own = std::min(octave.own + 1, 2);
    octave.means = {octave.means[1], mean};
    octave.has_half = !octave.has_half;
    if (octave.has_half) {
      octave.half = mean;
      return;
    }
    mean = 0.5 * (octave.half + mean);
  }
}

void RestNoise::judge() noexcept {
  if (!search_.advance(judging_ == Judging::kAll ? known_ : judged_)) return;
  switch (std::exchange(judging_, Judging::kNothing)) {
    case Judging::kNothing:
      break;
    case Judging::kBound:
      most_ratio_ = search_.quickest();
      break;
    case Judging::kChapter:
      compare();
      break;
    case Judging::kAll:
      judge_all();
      break;
  }
}

void RestNoise::judge_all() noexcept {
  if (most_ratio_ < search_.ratio()) {
    const double behind = fit_octaves(known_.squares, known_.counts, most_ratio_).misfit - search_.misfit();
    if (0.5 * behind > kSurely) most_ratio_ = kNoBound;
  }
  likeliest_ = search_.ratio();
  known_ratio_ = std::min({search_.quickest(), likelihood_.quickest(kNearlyAsWell), most_ratio_});
  news_ = true;
}

// The chapter that was read before this one with all that is known.
void RestNoise::compare() noexcept {
  if (known_.samples > 0.0) {
    // Quicker than the bound, or slower than what is likeliest: what lies between is in both.
    const double against = std::clamp(search_.ratio(), std::min(likeliest_, known_ratio_), known_ratio_);
    const double behind = fit_octaves(judged_.squares, judged_.counts, against).misfit - search_.misfit();
    const bool differ = 0.5 * behind > kSurely;
    const bool quicker = differ && search_.ratio() > known_ratio_;
    if (differ) {
      octaves_ = {};
      likelihood_.drop();
      begin_chapter();
    }
    if (quicker && (contradictions_ < 0 || ++contradictions_ < kContradicted)) return;
    // A bound may still turn out too slow.
    contradictions_ = !quicker && known_ratio_ == most_ratio_ ? 0 : -1;
    if (quicker) most_ratio_ = kNoBound;
    if (differ) {
      known_ = {};
      likelihood_.forget();
      judged_ = judged_own_;
    }
  }
  likelihood_.believe();
  for (std::size_t k = 0; k < kOctaves; ++k) {
    known_.squares[k] += judged_.squares[k];
    known_.counts[k] += judged_.counts[k];
  }
  known_.samples += judged_.samples;
  search_.begin(known_);
  judging_ = Judging::kAll;
}

std::optional<NoiseEstimate> RestNoise::take_news(double period_s) noexcept {
  if (!std::exchange(news_, false)) return std::nullopt;
  const OctaveFit fit = fit_octaves(known_.squares, known_.counts, known_ratio_);
  if (!(fit.noise > 0.0)) return std::nullopt;
  return NoiseEstimate{known_ratio_ * fit.low_noise / period_s, fit.noise, fit.low_noise};
}

}  // namespace ifog
