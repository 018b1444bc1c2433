// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/walk.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "filters/random/log_exp.h"

namespace ifog {
namespace {

constexpr int kBlock = 64;  // samples: longer than the colour of a sensor's output filter
// Second differences that overlap by two thirds count for half of their number.
constexpr double kIndependent = 0.5;
// An octave with fewer says nothing.
constexpr double kFewest = 5.0;
// Standard deviations: one octave in a thousand, of ten in a stretch, is further off by chance.
constexpr double kChance = 3.3;
// Octaves that colour may fill, and by how much the noise of long means may exceed that of differences of
// samples: a correlation of one half, an output filter with its corner at a sixth of the sample rate. What is
// slower is not told from the motion of a hand.
constexpr std::size_t kMostColour = 3;
constexpr double kMostExcess = 8.0;
// Octaves from here on, 32 samples, are long: shaking has its angle's bound there.
constexpr std::size_t kLong = 5;
// -2 log-likelihood by which two stretches surely differ: e^6.
constexpr double kSurely = 12.0;
// Difference of −2 log-likelihood that is one standard error wide.
constexpr double kNearly = 1.0;
constexpr int kContradicted = 64;  // quicker stretches in a row: what was known is of another sensor

}  // namespace

void Walk::Likelihood::add(const Likelihood& other) noexcept {
  for (std::size_t k = 0; k < kTrials; ++k) {
    squares[k] += other.squares[k];
    logs[k] += other.logs[k];
  }
  count += other.count;
}

double Walk::Likelihood::misfit(std::size_t k) const noexcept {
  return count > 0.0 ? count * logarithm(std::max(squares[k], 1e-300)) + logs[k] : 0.0;
}

Walk::Walk(double stretch) noexcept : stretch_(stretch) {
  double ratio = 1e-12;
  for (double& tried : ratios_) tried = std::exchange(ratio, 2.0 * ratio);
}

void Walk::recall(double ratio, double samples) noexcept {
  ratio_ = recalled_ = std::clamp(ratio, ratios_.front(), kMostRatio);
  samples_ = recalled_samples_ = samples;
}

void Walk::break_off() noexcept {
  if (in_stretch_ == 0.0) return;
  for (Axis& axis : axes_) {
    axis.octaves = {};
    axis.levels = {};
    axis.lately = {};
    axis.sum = axis.samples = 0.0;
    axis.in_block = 0;
    axis.next = kTrials;
  }
  in_stretch_ = 0.0;
}

void Walk::take(const Axes& rate, std::uint32_t valid_axes, bool learn) noexcept {
  if (valid_axes == 0) return;
  if (std::exchange(learn_, learn) != learn) break_off();
  for (std::size_t a = 0; a < kMaxAxes; ++a) {
    if ((valid_axes >> a & 1U) == 0) continue;
    axes_[a].samples += 1.0;
    add_octaves(axes_[a], rate[a]);
    add_block(axes_[a], rate[a]);
  }
  if (++in_stretch_ >= stretch_) judge();
}

void Walk::add_octaves(Axis& axis, double rate) noexcept {
  double mean = rate;
  for (Octave& octave : axis.octaves) {
    if (octave.blocks == 2) {
      const double second = mean - 2.0 * octave.means[1] + octave.means[0];
      octave.squares += kIndependent * second * second;
      octave.count += kIndependent;
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

// A block is worked in while the next one is read, one ratio a sample, so that no step takes longer than
// another.
void Walk::add_block(Axis& axis, double rate) noexcept {
  if (axis.next < kTrials) work_in(axis);
  axis.sum += rate;
  if (++axis.in_block < kBlock) return;
  axis.mean = axis.sum / kBlock;
  axis.sum = 0.0;
  axis.in_block = 0;
  axis.next = 0;
}

void Walk::work_in(Axis& axis) noexcept {
  const std::size_t k = axis.next++;
  Level& level = axis.levels[k];
  if (level.variance < 0.0) {
    level = {axis.mean, 1.0};
    return;
  }
  const double variance = level.variance + ratios_[k] * kBlock * kBlock, factor = 1.0 + variance;
  const double innovation = axis.mean - level.value;
  axis.lately.squares[k] += innovation * innovation / factor;
  axis.lately.logs[k] += logarithm(factor);
  if (k == 0) axis.lately.count += 1.0;
  level.variance = variance / factor;
  level.value += level.variance * innovation;
}

double Walk::misfit(Likelihood Axis::*of, std::size_t k) const noexcept {
  double sum = 0.0;
  for (const Axis& axis : axes_) sum += (axis.*of).misfit(k);
  return sum;
}

std::size_t Walk::likeliest(Likelihood Axis::*of, double nearly) const noexcept {
  std::array<double, kTrials> all{};
  for (std::size_t k = 0; k < kTrials; ++k) all[k] = misfit(of, k);
  std::size_t best = 0;
  for (std::size_t k = 1; k < kTrials; ++k)
    if (all[k] < all[best]) best = k;
  for (std::size_t k = kTrials; nearly > 0.0 && --k > best;)
    if (all[k] < all[best] + nearly) return k;
  return best;
}

// R of an axis if it is white noise and this walk from that octave on; 0 if it is not, NaN if nothing was
// measured.
double Walk::white_noise(const Axis& axis, double ratio, std::size_t first) const noexcept {
  double weighted = 0.0, total = 0.0;
  const auto shape = [ratio](std::size_t k) {
    const double block = std::ldexp(1.0, static_cast<int>(k));
    return 6.0 / block + ratio * block;
  };
  for (std::size_t k = first; k < kOctaves; ++k) {
    weighted += axis.octaves[k].squares / shape(k);
    total += axis.octaves[k].count;
  }
  if (!(weighted > 0.0)) return std::nan("");
  const double noise = weighted / total;
  double long_off = 0.0, long_count = 0.0;
  for (std::size_t k = first; k < kOctaves; ++k) {
    const Octave& octave = axis.octaves[k];
    if (octave.count < kFewest) break;
    // The logarithm of a mean of n squares is near normal: mean -1 / n, variance 2 / n.
    const double off = logarithm(octave.squares / octave.count / (noise * shape(k))) + 1.0 / octave.count;
    if (off * off * octave.count / 2.0 > kChance * kChance) return 0.0;
    if (k < kLong) continue;
    long_off += off * octave.count;
    long_count += 2.0 * octave.count;
  }
  // What is bounded is below in all long octaves, what turns above in all: together that shows sooner than in
  // one.
  if (long_off * long_off > kChance * kChance * long_count) return 0.0;
  return noise;
}

void Walk::judge() noexcept {
  const double ratio = ratios_[likeliest(&Axis::lately, 0.0)];
  bool noise = true;
  Found found{{}, ratio_, true, in_stretch_};
  for (std::size_t a = 0; noise && a < kMaxAxes; ++a) {
    if (axes_[a].samples < 0.25 * stretch_) continue;
    double level = 0.0;
    for (std::size_t first = 0; first <= kMostColour && level == 0.0; ++first) {
      level = white_noise(axes_[a], ratio, first);
      found.white = found.white && first == 0;
    }
    if (std::isnan(level)) continue;
    const Octave& shortest = axes_[a].octaves.front();
    if (!found.white && level > kMostExcess * shortest.squares / (6.0 * shortest.count)) level = 0.0;
    found.noise[a] = level;
    noise = level > 0.0;
  }
  if (noise && learn_) believe();
  found.ratio = ratio_;
  if (noise) news_ = found;
  // Octaves of the next stretch are its own; the levels of the likelihood go on.
  for (Axis& axis : axes_) {
    axis.octaves = {};
    axis.samples = 0.0;
    axis.lately = {};
    if (!noise) axis.levels = {};
  }
  in_stretch_ = 0.0;
}

void Walk::believe() noexcept {
  const std::size_t here = likeliest(&Axis::lately, 0.0);
  double known = 0.0;
  for (const Axis& axis : axes_) known += axis.all.count;
  std::size_t before = here;
  if (known > 0.0) {
    before = likeliest(&Axis::all, here > likeliest(&Axis::all, 0.0) ? kNearly : 0.0);
  } else if (recalled_ > 0.0) {
    while (before > 0 && ratios_[before] > recalled_) --before;
    while (before + 1 < kTrials && ratios_[before + 1] <= recalled_) ++before;
  }
  const bool differ = misfit(&Axis::lately, before) - misfit(&Axis::lately, here) > kSurely;
  quicker_ = differ && here > before ? (quicker_ + 1) % kContradicted : 0;
  if (quicker_ > 0) return;
  if (differ) recalled_ = recalled_samples_ = samples_ = 0.0;
  for (Axis& axis : axes_) {
    if (differ) axis.all = {};
    axis.all.add(axis.lately);
  }
  samples_ += in_stretch_;
  // What was recalled stands until this run has had as much.
  const bool more = samples_ >= 2.0 * recalled_samples_;
  ratio_ =
      recalled_ > 0.0 && !more ? recalled_ : std::min(ratios_[likeliest(&Axis::all, kNearly)], kMostRatio);
}

std::optional<Walk::Found> Walk::take_news() noexcept { return std::exchange(news_, std::nullopt); }

}  // namespace ifog
