// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/walk.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "filters/estimator/sample.h"
#include "filters/random/log_exp.h"

namespace ifog {
namespace {

// Overlapping differences of neighbouring blocks count for two thirds of their number.
constexpr double kIndependent = 2.0 / 3.0;
// Axes with fewer differences of a stretch's samples are not judged.
constexpr double kMeasured = 0.25 * kIndependent;
// Octaves with fewer differences are not used.
constexpr double kFewest = 5.0;
// Standard deviations: by chance one of 1000 octaves, in stretches of ten, exceeds it.
constexpr double kChance = 3.3;
// Octaves that colour may fill, and limit of the noise of long means over that of single differences: a
// correlation of 0.5, i.e. an output filter with its corner at 1/6 of the sample rate. Slower colour cannot
// be distinguished from the motion of a hand.
constexpr std::size_t kMostColour = 3;
constexpr double kMostExcess = 6.7;
// First long octave, 64 samples, which must have been seen: there the angle of shaking is bounded, and output
// filters are faster.
constexpr std::size_t kLong = 6;
// The same for a piece against the others: by chance one of a million.
constexpr double kOtherPiece = 5.0;
// Difference of -2 log-likelihood that refutes: e^6.
constexpr double kSurely = 12.0;
// Difference of -2 log-likelihood of one standard error.
constexpr double kNearly = 1.0;
// Stretches averaged: a million samples, which show a walk of 1e-9.
constexpr double kMemory = 256.0;
// Ratios tried: from the largest by halves down to 1e-12.
constexpr std::size_t kTrials = 31;

double ratio_of(std::size_t trial) noexcept {
  return std::ldexp(kMostRatio, static_cast<int>(trial) - static_cast<int>(kTrials - 1));
}

// Allan variance of noise and walk by octave for R = 1, and its logarithm.
struct Shape {
  double variance = 0.0, log = 0.0;
};
using Shapes = std::array<Shape, Walk::kOctaves>;

std::array<Shapes, kTrials> make_shapes() noexcept {
  std::array<Shapes, kTrials> all;
  for (std::size_t trial = 0; trial < kTrials; ++trial)
    for (std::size_t k = 0; k < Walk::kOctaves; ++k) {
      const double block = std::ldexp(1.0, static_cast<int>(k));
      const double variance = 1.0 / block + ratio_of(trial) * block / 3.0;
      all[trial][k] = {variance, logarithm(variance)};
    }
  return all;
}

const Shapes& shapes_of(std::size_t trial) noexcept {
  static const std::array<Shapes, kTrials> all = make_shapes();
  return all[trial];
}

}  // namespace

Walk::Walk(double stretch, bool in_pieces) noexcept
    : stretch_(stretch), of_piece_(in_pieces ? kPiece : stretch) {
  static_cast<void>(shapes_of(0));
}

void Walk::recall(double ratio, double samples) noexcept {
  ratio_ = std::clamp(ratio, ratio_of(0), kMostRatio);
  recalled_samples_ = std::min(samples, 0.5 * kMemory * kStretch);
}

void Walk::moved() noexcept {
  blocks_ = {};
  piece_ = {};
  in_piece_ = 0.0;
}

int Walk::against_others() const noexcept {
  int found = 0;
  for (std::size_t a = 0; a < kMaxAxes; ++a)
    for (std::size_t k = 0; k < kOctaves; ++k) {
      const double mine = piece_[a].counts[k], others = lately_[a].counts[k];
      // A coarse converter may show no noise for a while.
      const double times = piece_[a].sums[k] / mine / (lately_[a].sums[k] / others);
      if (mine < kFewest || others < kFewest || !(times > 0.0) || !std::isfinite(times)) continue;
      const double off = logarithm(times);
      if (off * off <= kOtherPiece * kOtherPiece * (2.0 / mine + 2.0 / others)) continue;
      if (off > 0.0) return 1;
      found = -1;
    }
  return found;
}

std::optional<Walk::Found> Walk::take(const Axes& rate, std::uint32_t valid_axes) noexcept {
  if (valid_axes == 0) return {};
  for (std::size_t a = 0; a < kMaxAxes; ++a)
    if ((valid_axes >> a & 1U) != 0) add(a, rate[a]);
  if (++in_piece_ < of_piece_) return {};
  // A piece that moves more than another is no rest.
  const int compared = against_others();
  if (compared > 0) {
    moved();
    return {};
  }
  if (compared < 0) lately_ = {}, in_stretch_ = 0.0;
  in_stretch_ += std::exchange(in_piece_, 0.0);
  merge(piece_, 1.0, lately_);
  piece_ = {};
  if (in_stretch_ < stretch_) return {};
  const bool seen = std::ranges::all_of(lately_, [&](const Allan& allan) {
    return allan.counts[0] < kMeasured * stretch_ || allan.counts[kLong] >= kFewest;
  });
  return seen ? judge() : std::nullopt;
}

void Walk::add(std::size_t axis, double rate) noexcept {
  double mean = rate;
  // An axis whose present level differs does not count for the others.
  if (const double count = piece_[axis].counts[0] + lately_[axis].counts[0],
      sum = piece_[axis].sums[0] + lately_[axis].sums[0];
      blocks_[axis][0].has_mean && count >= kFewest && sum > 0.0) {
    const double most = kMostDeviations * std::sqrt(2.0 * sum / count);
    const double last = blocks_[axis][0].mean;
    mean = std::clamp(rate, last - most, last + most);
  }
  for (std::size_t k = 0; k < kOctaves; ++k) {
    Block& block = blocks_[axis][k];
    if (block.has_mean) {
      const double difference = mean - block.mean;
      piece_[axis].sums[k] += 0.5 * kIndependent * difference * difference;
      piece_[axis].counts[k] += kIndependent;
    }
    block.has_mean = true;
    block.mean = mean;
    block.has_half = !block.has_half;
    if (block.has_half) {
      block.half = mean;
      return;
    }
    mean = 0.5 * (block.half + mean);
  }
}

void Walk::merge(const Octaves& more, double kept, Octaves& into) noexcept {
  for (std::size_t a = 0; a < kMaxAxes; ++a)
    for (std::size_t k = 0; k < kOctaves; ++k) {
      into[a].sums[k] = kept * into[a].sums[k] + more[a].sums[k];
      into[a].counts[k] = kept * into[a].counts[k] + more[a].counts[k];
    }
}

double Walk::misfit(const Octaves& of, std::size_t trial) noexcept {
  const Shapes& shapes = shapes_of(trial);
  double sum = 0.0;
  for (const Allan& allan : of) {
    double squares = 0.0, count = 0.0;
    for (std::size_t k = kLong; k < kOctaves; ++k) {
      squares += allan.sums[k] / shapes[k].variance;
      sum += allan.counts[k] * shapes[k].log;
      count += allan.counts[k];
    }
    if (count > 0.0) sum += count * logarithm(std::max(squares / count, 1e-300));
  }
  return sum;
}

std::size_t Walk::likeliest(const Octaves& of, double nearly) noexcept {
  std::array<double, kTrials> all{};
  for (std::size_t k = 0; k < kTrials; ++k) all[k] = misfit(of, k);
  std::size_t best = 0;
  for (std::size_t k = 1; k < kTrials; ++k)
    if (all[k] < all[best]) best = k;
  for (std::size_t k = kTrials; nearly > 0.0 && --k > best;)
    if (all[k] < all[best] + nearly) return k;
  return best;
}

double Walk::white_noise(const Allan& allan, std::size_t trial, std::size_t first) noexcept {
  const Shapes& shapes = shapes_of(trial);
  double weighted = 0.0, total = 0.0;
  for (std::size_t k = first; k < kOctaves; ++k) {
    weighted += allan.sums[k] / shapes[k].variance;
    total += allan.counts[k];
  }
  if (!(weighted > 0.0)) return std::nan("");
  const double noise = weighted / total;
  double long_off = 0.0, long_count = 0.0;
  for (std::size_t k = first; k < kOctaves && allan.counts[k] >= kFewest; ++k) {
    const double count = allan.counts[k];
    // The logarithm of a mean of n squares is nearly normal: mean -1 / n, variance 2 / n.
    const double off = logarithm(allan.sums[k] / count / (noise * shapes[k].variance)) + 1.0 / count;
    if (off * off * count / 2.0 > kChance * kChance) return 0.0;
    if (k < kLong) continue;
    long_off += off * count;
    long_count += 2.0 * count;
  }
  // A bounded angle is low in all long octaves, a turn high in all, so their sum is a sharper test.
  if (long_off * long_off > kChance * kChance * long_count) return 0.0;
  return noise;
}

std::optional<Walk::Found> Walk::judge() noexcept {
  const std::size_t trial = likeliest(lately_, 0.0);
  bool noise = true;
  Found found{{}, ratio_, true};
  for (std::size_t a = 0; noise && a < kMaxAxes; ++a) {
    const Allan& allan = lately_[a];
    if (allan.counts[0] < kMeasured * stretch_) continue;
    double level = 0.0;
    for (std::size_t first = 0; first <= kMostColour && level == 0.0; ++first) {
      level = white_noise(allan, trial, first);
      found.white = found.white && first == 0;
    }
    if (std::isnan(level)) continue;
    if (!found.white && level > kMostExcess * allan.sums[0] / allan.counts[0]) level = 0.0;
    found.noise[a] = level;
    noise = level > 0.0;
  }
  if (noise) believe();
  found.ratio = ratio_;
  // The long blocks continue if it was noise.
  if (!noise) blocks_ = {};
  lately_ = {};
  in_stretch_ = 0.0;
  return noise ? std::optional(found) : std::nullopt;
}

void Walk::believe() noexcept {
  const double kept = 1.0 - 1.0 / kMemory;
  merge(lately_, kept, all_);
  samples_ = kept * samples_ + in_stretch_;
  // The recalled ratio is valid until this run has as many samples or contradicts it.
  std::size_t recalled = 0;
  while (recalled + 1 < kTrials && ratio_of(recalled + 1) <= ratio_) ++recalled;
  if (samples_ >= recalled_samples_ || misfit(all_, recalled) - misfit(all_, likeliest(all_, 0.0)) > kSurely)
    recalled_samples_ = 0.0;
  if (recalled_samples_ == 0.0) ratio_ = ratio_of(likeliest(all_, kNearly));
}

}  // namespace ifog
