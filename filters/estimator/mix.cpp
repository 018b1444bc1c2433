// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/mix.h"

#include <algorithm>

#include "filters/estimator/ledger.h"
#include "filters/estimator/noise.h"
#include "filters/random/log_exp.h"

namespace ifog {
namespace {

// Prior in nats: the longer of two neighbours is more likely, as motions are mostly smooth; the filter at
// rest is less likely, as motion was detected.
constexpr double kPrior = 2.0;
// Variance of the difference of two neighbours due to white noise, as a share of the difference of their
// variances.
constexpr double kCommon = 0.65;
// kCorrelated: twice the correlation of neighbours' errors, 1.26 to 1.45 of the longer one's variance. kPaid:
// variance, in R / n, of a payment over n samples of the noise's shortfall.
constexpr double kCorrelated = 2.8, kPaid = 0.75;

// More than an output filter makes of white noise, so the given R says that it is not motion.
constexpr double kStronglyColoured = 8.0;

double certain(double nats) { return 1.0 / (1.0 + exponential(-std::clamp(nats, -30.0, 30.0))); }

}  // namespace

double Mix::least(const Lanes& lanes) const noexcept {
  if (!(seen_ > 0.0).any()) return 0.0;
  return (seen_ > 0.0).select(lanes, Lanes::Constant(1e300)).minCoeff();
}

void Mix::begin(std::size_t found) noexcept {
  link_.fill(Lanes::Zero());
  bias_.fill(Lanes::Zero());
  ahead_.fill(Lanes::Zero());
  held_.setZero();
  weight_ = {};
  compared_ = {};
  weight_[found] = gain_ = 1.0;
  rest_ratio_.setZero();
  seen_.setZero();
  age_ = rest_age_ = rest_weight_ = failed_after_ = 0.0;
}

void Mix::begin_rest() noexcept {
  failed_after_ = std::max(0.9 * failed_after_, rest_age_);
  rest_age_ = 0.0;
  rest_ratio_.setZero();
}

bool Mix::rest_found() const noexcept {
  return least(rest_ratio_) > kFound && rest_age_ >= std::max(kRestMemory, 3.0 * failed_after_);
}

void Mix::take(Trackers& trackers, const Sample& now, const Lanes& colour, const Lanes& rest,
               double common) noexcept {
  const std::size_t size = trackers.size();
  seen_ = seen_.max(now.mask);
  std::array<Lanes, Trackers::kMost> risk;
  Lanes mean = Lanes::Zero();
  double output = 0.0;
  age_ = std::min(age_ + 1.0, kShortGap);
  if (age_ > 1.0) held_ += now.mask * ((now.rate - last_).square() - held_) * (1.0 / (age_ - 1.0));
  last_ = (now.mask > 0.0).select(now.rate, last_);
  for (std::size_t j = 0; j < size; ++j) {
    const Trackers::Gains& g = trackers.gains(j);
    const double gain = trackers.predicts(j) ? g.rate : 1.0;
    const Lanes error = now.rate - trackers.rate(j), left = (1.0 - gain) * error;
    ahead_[j] += now.mask * (error * error - ahead_[j]) * (1.0 / age_);
    risk[j] = left * left * now.inverse + 2.0 * gain;
    mean += weight_[j] * risk[j];
    output += weight_[j] * (trackers.predicts(j) ? g.output : 1.0);
  }
  mean /= 1.0 - rest_weight_;
  output /= 1.0 - rest_weight_;
  // Lower limit of the residual for a tracker in white noise. In coloured noise it follows the noise, in
  // strongly coloured noise almost like the raw measurement.
  mean = (colour > kColoured).select(mean.max(1.0 + output), mean);
  mean = (colour > kStronglyColoured).select(mean.max(2.0 - (1.0 - output) / colour), mean);
  const Lanes left = (now.rate - rest).square() * now.inverse;
  const Lanes ahead = (0.5 * (mean - left) - common).max(-kMostNats).min(kMostNats);
  rest_ratio_ = (now.mask > 0.0).select((rest_ratio_ + ahead).min(kMostNats), rest_ratio_);
  rest_age_ += 1.0;
  // The raw measurement is tested without delay, since broadband motion may be short. The choice between
  // trackers is independent of the present sample's noise.
  const auto compare = [&](std::size_t j) {
    link_[j] += now.mask * (0.5 * (risk[j - 1] - risk[j])).max(-kMostNats).min(kMostNats) -
                link_[j] * (1.0 / std::max(5.0, 3.0 * trackers.length(j - 1)));
  };
  compare(1);
  trackers.correct(now.rate, now.mask);
  rest_weight_ = rest_age_ >= 3.0 * failed_after_ ? certain(least(rest_ratio_) - kPrior) : 0.0;
  double remains = 1.0 - rest_weight_;
  gain_ = 0.0;
  for (std::size_t j = 0; j < size; ++j) {
    const double longer = j + 1 < size ? remains * certain(least(link_[j + 1]) + kPrior) : 0.0;
    weight_[j] = remains - longer;
    remains = longer;
    gain_ += weight_[j] * (trackers.predicts(j) ? trackers.gains(j).rate : 1.0);
  }
  for (std::size_t j = 2; j < size; ++j) compare(j);
  for (std::size_t j = 1; j < size; ++j) {
    // The difference scatters by at most R / 8.
    compared_[j] = std::min(compared_[j] + 1.0, std::max(2.0 * kRestMemory, trackers.horizon(j)));
    const Lanes apart = trackers.rate(j) - trackers.rate(j - 1);
    const double scatter = kCommon * std::max(0.0, trackers.gains(j - 1).output - trackers.gains(j).output);
    bias_[j] += now.mask * (apart * apart - scatter * now.scale - bias_[j]) * (1.0 / compared_[j]);
  }
}

Mix::Published Mix::publish(const Trackers& trackers, const Lanes& rest, const Lanes& rest_variance,
                            const Lanes& scale, double lag) const noexcept {
  Lanes moving = Lanes::Zero(), bias = Lanes::Zero(), noise = Lanes::Zero();
  double shorter = 0.0, gain = 0.0;
  for (std::size_t j = 0; j < trackers.size(); ++j) {
    const double weight = weight_[j];
    if (j > 0) bias += (1.0 - shorter) * (1.0 - shorter) * bias_[j];
    noise += trackers.gains(j).output * weight * (weight + kCorrelated * shorter);
    gain += weight * trackers.gains(j).rate;
    shorter += weight;
    moving += weight * trackers.rate(j);
  }
  Published out;
  out.gain = gain;
  const double share = 1.0 - rest_weight_;
  const double falls_short = shorter - gain;
  const double paid = kPaid * falls_short * falls_short / Ledger::pace_of(length(trackers, lag));
  out.variance = (noise.max((noise * trackers.stride()).min(1.0)) + paid) * scale + bias.max(0.0);
  if ((trackers.since() > 0.0).any()) predict(trackers, scale, moving, out.variance);
  out.rate = rest_weight_ * rest + moving;
  const Lanes apart = rest - moving / share;
  out.variance += rest_weight_ * (rest_variance + share * apart * apart);
  return out;
}

// Axes without a measurement: the best prediction of late, or holding, with its error, at least that of white noise.
void Mix::predict(const Trackers& trackers, const Lanes& scale, Lanes& moving,
                  Lanes& variance) const noexcept {
  Lanes least = Lanes::Constant(1e300), best = last_;
  if (age_ > 1.0) least = held_.max(2.0 * scale) * trackers.since().square();
  for (std::size_t j = 0; j < trackers.size(); ++j) {
    if (!trackers.predicts(j)) continue;
    const Lanes reach = trackers.reach(j);
    const Lanes error = ahead_[j].max(trackers.gains(j).factor * scale) * (reach * reach * reach).square();
    best = (error < least).select(trackers.rate(j), best);
    least = least.min(error);
  }
  const auto missing = trackers.since() > 0.0 && least < 1e300;
  moving = missing.select((1.0 - rest_weight_) * best, moving);
  variance = missing.select(least, variance);
}

double Mix::length(const Trackers& trackers, double lag) const noexcept {
  double length = rest_weight_ * lag;
  for (std::size_t j = 0; j < trackers.size(); ++j) length += weight_[j] * trackers.length(j);
  return length;
}

}  // namespace ifog
