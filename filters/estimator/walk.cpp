// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/walk.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "filters/random/log_exp.h"

namespace ifog {
namespace {

// Second differences that overlap by two thirds count for half of their number.
constexpr double kIndependent = 0.5;
// An octave with fewer says nothing of whether a stretch is noise.
constexpr double kFewest = 5.0;
// Standard deviations: one octave in a thousand, of ten in a stretch, is further off by chance.
constexpr double kChance = 3.3;
// Octaves that colour may fill, and by how much the noise of long means may exceed that of differences of
// samples: a correlation of one half, an output filter with its corner at a sixth of the sample rate. What is
// slower cannot be told from the motion of a hand.
constexpr std::size_t kMostColour = 3;
constexpr double kMostExcess = 8.0;
// Octaves from here on, 64 samples, show the walk.
constexpr std::size_t kLong = 6;
// An octave is never said to be further off than a tenth of its deviation, which heavy tails may make.
constexpr double kTails = 0.1;
// Ratios that are tried: octaves from 1e-12, slower than any gyro, to what the stretch of a walk of kMostRatio
// may look like, as the likeliest ratio of one stretch scatters by a factor of three.
constexpr double kSlowest = 1e-12, kStretchRatio = 8.0 * kMostRatio;
// -2 log-likelihood by which two stretches surely differ: e^6.
constexpr double kSurely = 12.0;

double shape(std::size_t octave, double ratio) noexcept {
  const double block = std::ldexp(1.0, static_cast<int>(octave));
  return 6.0 / block + ratio * block;
}

}  // namespace

void Walk::Evidence::add(const Evidence& other) noexcept {
  for (std::size_t k = 0; k < kOctaves; ++k) {
    squares[k] += other.squares[k];
    count[k] += other.count[k];
  }
}

void Walk::recall(const Axes& noise, double ratio, double samples) noexcept {
  ratio_ = std::clamp(ratio, kSlowest, kMostRatio);
  samples_ = samples;
  for (std::size_t a = 0; a < kMaxAxes; ++a)
    for (std::size_t k = 0; k < kOctaves; ++k) {
      Evidence& all = axes_[a].all;
      all.count[k] = noise[a] > 0.0 ? kIndependent * std::ldexp(samples, -static_cast<int>(k)) : 0.0;
      all.squares[k] = all.count[k] * noise[a] * shape(k, ratio_);
    }
}

void Walk::break_off() noexcept {
  if (in_stretch_ == 0.0) return;
  for (Axis& axis : axes_) axis = {{}, {}, axis.all, 0.0};
  in_stretch_ = 0.0;
}

void Walk::take(const Axes& rate, std::uint32_t valid_axes, bool learn) noexcept {
  if (valid_axes == 0) return;
  if (std::exchange(learn_, learn) != learn) break_off();
  for (std::size_t a = 0; a < kMaxAxes; ++a) {
    if ((valid_axes >> a & 1U) == 0) continue;
    Axis& axis = axes_[a];
    axis.samples += 1.0;
    double mean = rate[a];
    for (std::size_t k = 0; k < kOctaves; ++k) {
      Octave& octave = axis.octaves[k];
      if (octave.blocks == 2) {
        const double second = mean - 2.0 * octave.means[1] + octave.means[0];
        axis.lately.squares[k] += kIndependent * second * second;
        axis.lately.count[k] += kIndependent;
      } else {
        ++octave.blocks;
      }
      octave.means = {octave.means[1], mean};
      octave.has_half = !octave.has_half;
      if (octave.has_half) {
        octave.half = mean;
        break;
      }
      mean = 0.5 * (octave.half + mean);
    }
  }
  if (++in_stretch_ >= stretch_) judge();
}

// -2 log-likelihood of a ratio by the long octaves, R left open.
double Walk::misfit(const Evidence& evidence, double ratio) noexcept {
  double squares = 0.0, count = 0.0, logs = 0.0;
  for (std::size_t k = kLong; k < kOctaves && evidence.count[k] > 0.0; ++k) {
    const double expected = shape(k, ratio);
    squares += evidence.squares[k] / expected;
    count += evidence.count[k];
    logs += evidence.count[k] * logarithm(expected);
  }
  return count > 0.0 ? count * logarithm(std::max(squares / count, 1e-300)) + logs : 0.0;
}

double Walk::misfit(Evidence Axis::*of, double ratio) const noexcept {
  double sum = 0.0;
  for (const Axis& axis : axes_) sum += misfit(axis.*of, ratio);
  return sum;
}

double Walk::likeliest(Evidence Axis::*of) const noexcept {
  double least = 1e300, likeliest = kSlowest;
  for (double ratio = kSlowest; ratio <= 2.0 * kStretchRatio; ratio *= 2.0) {
    const double here = misfit(of, ratio);
    if (here >= least) continue;
    least = here;
    likeliest = ratio;
  }
  return likeliest;
}

double Walk::mean_ratio() const noexcept {
  const double least = misfit(&Axis::all, likeliest(&Axis::all));
  double weights = 0.0, ratios = 0.0;
  for (double ratio = kSlowest; ratio <= 2.0 * kStretchRatio; ratio *= 2.0) {
    const double weight = exponential(std::max(-600.0, 0.5 * (least - misfit(&Axis::all, ratio))));
    weights += weight;
    ratios += weight * ratio;
  }
  return std::min(ratios / weights, kMostRatio);
}

// R of an axis if it is white noise and this walk from that octave on; 0 if it is not, NaN if nothing was
// measured.
double Walk::white_noise(const Evidence& evidence, double ratio, std::size_t first) noexcept {
  double weighted = 0.0, total = 0.0;
  for (std::size_t k = first; k < kOctaves; ++k) {
    weighted += evidence.squares[k] / shape(k, ratio);
    total += evidence.count[k];
  }
  if (!(weighted > 0.0)) return std::nan("");
  const double noise = weighted / total;
  double misfit = 0.0, tested = 0.0;
  for (std::size_t k = first; k < kOctaves && evidence.count[k] >= kFewest; ++k) {
    // The logarithm of a mean of n squares is near normal: mean -1 / n, variance 2 / n. That of heavy tails
    // is wider.
    const double count = evidence.count[k];
    const double off = logarithm(evidence.squares[k] / count / (noise * shape(k, ratio))) + 1.0 / count;
    const double square = off * off * count / 2.0;
    if (std::abs(off) <= kTails) continue;
    misfit += square;
    tested += 1.0;
    if (square > kChance * kChance) return 0.0;
  }
  return misfit <= tested + kChance * std::sqrt(2.0 * tested) ? noise : 0.0;
}

void Walk::judge() noexcept {
  const double ratio = likeliest(&Axis::lately);
  bool noise = ratio <= kStretchRatio;
  Found found{{}, ratio_, true, in_stretch_};
  for (std::size_t a = 0; noise && a < kMaxAxes; ++a) {
    if (axes_[a].samples < 0.25 * stretch_) continue;
    const Evidence& lately = axes_[a].lately;
    double level = 0.0;
    for (std::size_t first = 0; first <= kMostColour && level == 0.0; ++first) {
      level = white_noise(lately, ratio, first);
      found.white = found.white && first == 0;
    }
    if (std::isnan(level)) continue;
    if (!found.white && level > kMostExcess * lately.squares[0] / (6.0 * lately.count[0])) level = 0.0;
    found.noise[a] = level;
    noise = level > 0.0;
  }
  if (!noise) {
    break_off();
    return;
  }
  if (learn_) believe();
  found.ratio = ratio_;
  news_ = found;
  // The octaves go on: what is longer than a stretch is in the sum of all.
  for (Axis& axis : axes_) {
    axis.lately = {};
    axis.samples = 0.0;
  }
  in_stretch_ = 0.0;
}

void Walk::believe() noexcept {
  const double here = likeliest(&Axis::lately), before = likeliest(&Axis::all);
  const bool slower = samples_ > 0.0 && here < before &&
                      misfit(&Axis::lately, before) - misfit(&Axis::lately, here) > kSurely;
  if (slower) samples_ = 0.0;
  for (Axis& axis : axes_) {
    if (slower) axis.all = {};
    axis.all.add(axis.lately);
  }
  samples_ += in_stretch_;
  ratio_ = mean_ratio();
}

std::optional<Walk::Found> Walk::take_news() noexcept { return std::exchange(news_, std::nullopt); }

}  // namespace ifog
