// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/motion_mix.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "filters/random/log_exp.h"

namespace ifog {
namespace {

// What speaks for the longer of two trackers before anything is known: it is the quieter one.
constexpr double kForLonger = 2.0;
// What speaks against the filter at rest: it was wrong.
constexpr double kAgainstRest = 4.0;
// Least log-likelihood ratio with which the motion is over, and least samples; most that is counted, so that
// a new motion need not make up for a long rest.
constexpr double kOver = 9.0;
constexpr double kLeastSamples = 64.0;
constexpr double kMostRatio = 12.0;
constexpr double kWrong = -6.0;
constexpr double kBroken = -12.0;
// Times as long as it held before it failed.
constexpr double kHoldLonger = 3.0;
constexpr double kForgetFailure = 0.9;
// A normalised square this much above the least one says no more: one bad sample must not rule a tracker out
// for long.
constexpr double kMostSquare = 25.0;
// Log-likelihood of a measurement for a tracker that foresees nothing: less than for one that is right, more
// than for one that is wrong.
constexpr double kNothingForeseen = -6.0;

// Of what two trackers differ by so many of the longer one's memories are averaged.
constexpr double kBiasMemories = 6.0;
// From the trackers' impulse responses: the variance of the difference of two neighbours over the difference
// of their variances, of the first two and of all others; and the covariance of any two over the variance of
// the longer one. From memories of five samples on they hardly change.
constexpr double kFirstApart = 0.09;
constexpr double kApart = 0.65;
constexpr double kShared = 1.4;

// Of a square over a variance that is known with so many degrees of freedom: -2 log-likelihood of Student's
// t.
double unlikely(double square, double degrees) noexcept {
  constexpr double kMany = 1e5;
  return degrees > kMany ? square : (degrees + 1.0) * logarithm(1.0 + square / degrees);
}

double certain(double ratio) noexcept { return 1.0 / (1.0 + exponential(-std::clamp(ratio, -30.0, 30.0))); }

}  // namespace

void MotionMix::begin(double failed_after) noexcept {
  link_ = {};
  bias_square_ = {};
  compared_ = {};
  weight_ = {};
  weight_[0] = 1.0;
  rest_weight_ = rest_ratio_ = rest_age_ = 0.0;
  failed_after_ = failed_after;
}

// Of coloured noise a tracker foresees part. At rest, too: so it is no reason against the filter at rest that
// it foresees less than what it is known by. And what speaks for either comes in rows as long as its
// neighbours are alike, about the square root of its colour times as wide as in white noise.
void MotionMix::judge(const TrackerBank& trackers, const Surprise& now, const Axes& least,
                      const Axes& colour) noexcept {
  std::array<double, TrackerBank::kMost> log{};
  const double sum = std::accumulate(weight_.begin(), weight_.begin() + trackers.size(), 0.0);
  double for_rest = 0.0;
  for (std::size_t a = 0; a < kMaxAxes; ++a) {
    if ((now.valid >> a & 1U) == 0) continue;
    const double scale = now.scale[a], degrees = now.degrees[a];
    const double foreseen = unlikely(least[a], degrees);
    double mean = 0.0;
    for (std::size_t j = 0; j < trackers.size(); ++j) {
      double here = kNothingForeseen;
      if (trackers.foresees(j, a)) {
        const double apart = now.rate[a] - trackers.rate(j, a);
        const double factor = trackers.factor(j, a);
        const double log_factor = trackers.since(a) == 1.0 ? trackers.log_factor(j) : logarithm(factor);
        const double square = apart * apart / (factor * scale);
        here = -0.5 * (std::min(unlikely(square, degrees) - foreseen, kMostSquare) + log_factor);
      }
      log[j] += here;
      mean += sum > 1e-9 ? weight_[j] * here / sum : (j == 0 ? here : 0.0);
    }
    const double square = now.innovation[a] * now.innovation[a] / (now.rest_factor * scale);
    const double of_rest =
        -0.5 * (std::min(unlikely(square, degrees) - foreseen, kMostSquare) + logarithm(now.rest_factor));
    if (colour[a] > 1.0) mean = std::min(mean, -0.5 * (1.0 - foreseen));
    for_rest += (of_rest - mean) / std::sqrt(colour[a]);
  }
  for (std::size_t j = 1; j < trackers.size(); ++j)
    link_[j] += log[j] - log[j - 1] - link_[j] / ChangeTest::horizon(trackers.length(j - 1));
  rest_ratio_ = std::min(rest_ratio_ + for_rest, kMostRatio);
  rest_age_ += 1.0;
}

void MotionMix::weigh(const TrackerBank& trackers) noexcept {
  const bool judged = rest_age_ > 0.0 && rest_age_ >= kHoldLonger * failed_after_;
  rest_weight_ = judged ? certain(rest_ratio_ - kAgainstRest) : 0.0;
  double up_to_here = 1.0 - rest_weight_;
  for (std::size_t j = 0; j < trackers.size(); ++j) {
    const double next = j + 1 < trackers.size() ? up_to_here * certain(link_[j + 1] + kForLonger) : 0.0;
    weight_[j] = up_to_here - next;
    up_to_here = next;
  }
}

std::size_t MotionMix::broken(const TrackerBank& trackers) noexcept {
  for (std::size_t j = 1; j < trackers.size(); ++j) {
    if (link_[j] >= kBroken || trackers.age(j) <= trackers.age(j - 1)) continue;
    for (std::size_t k = j; k < trackers.size(); ++k) link_[k] = 0.0;
    return j;
  }
  return trackers.size();
}

bool MotionMix::rest_is_wrong() const noexcept { return rest_ratio_ < kWrong; }

void MotionMix::begin_rest() noexcept {
  failed_after_ = std::max(kForgetFailure * failed_after_, rest_age_);
  rest_age_ = rest_ratio_ = 0.0;
}

bool MotionMix::rest_is_right() const noexcept {
  return rest_ratio_ > kOver && rest_age_ >= std::max(kLeastSamples, kHoldLonger * failed_after_);
}

double MotionMix::rate(const TrackerBank& trackers, std::size_t axis, double rest) const noexcept {
  double mean = rest_weight_ * rest;
  for (std::size_t j = 0; j < trackers.size(); ++j) mean += weight_[j] * trackers.rate(j, axis);
  return mean;
}

void MotionMix::compare(const TrackerBank& trackers, const Surprise& now) noexcept {
  for (std::size_t j = 1; j < trackers.size(); ++j) {
    const double most = kBiasMemories * trackers.length(j);
    compared_[j] = std::min(compared_[j] + 1.0, most);
    const double of_noise = (j == 1 ? kFirstApart : kApart) *
                            std::max(0.0, trackers.output_factor(j - 1) - trackers.output_factor(j));
    for (std::size_t a = 0; a < kMaxAxes; ++a) {
      if ((now.valid >> a & 1U) == 0) continue;
      const double apart = trackers.rate(j, a) - trackers.rate(j - 1, a);
      double& square = bias_square_[a][j];
      square += (apart * apart - of_noise * now.scale[a] - square) / compared_[j];
    }
  }
}

MotionMix::Doubt MotionMix::doubt(const TrackerBank& trackers, std::size_t axis, double rest,
                                  double rest_variance, double scale) const noexcept {
  double noise = 0.0, bias = 0.0, drift = 0.0, shorter = 0.0, mean = 0.0;
  for (std::size_t j = 0; j < trackers.size(); ++j) {
    const double longer = 1.0 - shorter;
    if (j > 0) bias += longer * longer * bias_square_[axis][j];
    // Where the axis has no measurement of this sample: of what is foreseen, or else held.
    const bool foreseen = trackers.foresees(j, axis);
    const double factor =
        trackers.since(axis) > 0.0 && foreseen ? trackers.factor(j, axis) - 1.0 : trackers.output_factor(j);
    if (!foreseen) drift += weight_[j] * trackers.drift_square(j, axis);
    noise += factor * weight_[j] * (weight_[j] + 2.0 * kShared * shorter);
    shorter += weight_[j];
    mean += weight_[j] * trackers.rate(j, axis);
  }
  // Either the filter at rest is right or the trackers are.
  const double moving = 1.0 - rest_weight_;
  const double apart = moving > 1e-9 ? rest - mean / moving : 0.0;
  return {noise * scale, std::max(0.0, bias),
          drift + rest_weight_ * (rest_variance + moving * apart * apart)};
}

double MotionMix::gain(const TrackerBank& trackers, double rest_gain) const noexcept {
  double mean = rest_weight_ * rest_gain;
  for (std::size_t j = 0; j < trackers.size(); ++j) mean += weight_[j] * trackers.gain(j);
  return mean;
}

double MotionMix::length(const TrackerBank& trackers, double rest_gain) const noexcept {
  // A mean of n has gain 1/n; it lags by a quarter of what a parabola over n would forget.
  double mean = rest_gain > 0.0 ? rest_weight_ * 0.25 / rest_gain : 0.0;
  for (std::size_t j = 0; j < trackers.size(); ++j) mean += weight_[j] * trackers.length(j);
  return mean;
}

}  // namespace ifog
