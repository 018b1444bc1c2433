// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/change_test.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "filters/estimator/noise.h"
#include "filters/random/log_exp.h"

namespace ifog {
namespace {

// Shaking: innovations of that variance, in R; half its logarithm is ln 2.
constexpr double kShakingVariance = 4.0;
// Sums that are learned from: half of them overlap, so that 180 know their variance to 15 %; and what the prior is
// worth.
constexpr double kMostHorizons = 180.0, kPriorHorizons = 10.0;
}  // namespace

// Evidence by the sizes of the errors alone, of so many as are independent by their fourth moment.
double ChangeTest::same_size(const Contest& c, Eigen::Index a) const noexcept {
  return 0.5 * c.rest[a] * c.rest[a] / std::max(c.rest2[a], 1e-9) *
         logarithm((4.0 + c.rest[a]) / (4.0 + c.tracker[a]));
}

void ChangeTest::begin() noexcept {
  for (Contest& c : contest_)
    c.ratio = c.sum = c.weight = c.times = c.rest = c.rest2 = c.tracker = Lanes::Zero();
  forget_angle();
  shaking_.setZero();
  unseen_.setZero();
  suspected_ = false;
  age_ = 0.0;
}

// An offset that makes R into kShakingVariance R has a prior variance of m / n of R, where n is what a sum over the
// horizon is worth. A sum of normalised square z^2 is likelier by it by exp(z^2 / 2 m / (m + 1)) / sqrt(m + 1).
ChangeTest::ChangeTest(const Trackers& trackers) noexcept {
  forget_angle();
  for (std::size_t j = 0; j < Trackers::kMost; ++j) {
    const double h = trackers.horizon(j), m = (kShakingVariance - 1.0) * h * h / (2.0 * h - 1.0);
    contest_[j].shrinks = 0.5 * m / (m + 1.0);
    contest_[j].spread = 0.5 * logarithm(m + 1.0);
    contest_[j].keep = 1.0 - 1.0 / h;
    contest_[j].worth = 1.0 / (2.0 * h - 1.0);
  }
}

// Bayes: a change over the horizon is as likely beforehand as it has been on average at this rest. A sum that speaks
// against a change counts as none.
void ChangeTest::expect(Contest& c, double h, const Lanes& nats, const Sample& now) noexcept {
  Lanes likely = Lanes::Zero();
  for (Eigen::Index a = 0; a < kMaxAxes; ++a) {
    if (!(nats[a] > 0.0)) continue;
    const double often = (0.5 * h + c.times[a]) / (h + age_);
    const double begun = often * exponential(std::min(nats[a], kEvidence));
    likely[a] = begun / (begun + 1.0 - often);
  }
  c.times += now.mask * likely;
  unseen_ = unseen_.max(likely * now.scale * (c.sum / c.weight.max(1.0)).square());
}

void ChangeTest::contest(const Trackers& trackers, std::size_t j, const Sample& now, const Common& common,
                         const Lanes& colour) noexcept {
  Contest& c = contest_[j];
  const Trackers::Gains& g = trackers.gains(j);
  const double h = trackers.horizon(j), keep = c.keep;
  const Lanes error = now.rate - trackers.rate(j);
  const Lanes mine = error * error * now.inverse * (1.0 / g.factor);
  c.sum = keep * c.sum + common.clipped;
  c.weight = keep * c.weight + now.mask;
  // How many innovations of full weight the sum is worth: its variance over R.
  const Lanes n = (c.weight * (2.0 * h - c.weight) * c.worth).max(1.0);
  Lanes& likely = c.divisor.setOnes();
  Lanes share = now.mask;
  if (coloured_) {
    c.horizons = (c.horizons + now.mask / h).min(kMostHorizons);
    c.wide += now.mask * (c.sum.square() / n - c.wide) / (h * (c.horizons + 1.0));
    // Until it is learned the width is the widest that the known noise allows with its third differences.
    const Lanes prior = (h * (1.0 - 1.0 / colour)).max(1.0);
    const Lanes wide = (kPriorHorizons * prior + c.horizons * c.wide) / (kPriorHorizons + c.horizons);
    likely = (colour > kColoured).select((wide / common.louder).max(1.0), likely);
    widest_ = widest_.max(likely);
    share /= likely;  // correlated neighbours count once; the limit is an outlier's rarity
  }
  const Lanes evidence = 0.5 * ((now.surprise * share).min(common.cap) - (mine * share).min(common.cap) +
                                (common.log_rest - g.log_factor) * share);
  const Lanes limit = c.spread * n * likely, square = c.shrinks * c.sum.square();
  if ((square > limit).any()) expect(c, h, (square - limit) / (n * likely), now);
  short_[j] = keep * short_[j] + now.short_rad;
  c.ratio = (keep * c.ratio + evidence).max(0.0);
  c.rest = keep * c.rest + common.squares;
  c.rest2 = keep * c.rest2 + common.squares.square();
  c.tracker = keep * c.tracker + mine.min(kFarSquare);
}

std::optional<std::size_t> ChangeTest::take(const Trackers& trackers, const Sample& now, const Lanes& colour,
                                            double rarity, double lag) noexcept {
  const Lanes capped = now.surprise.min(2.0 * rarity);
  const Common common{(now.innovation * now.inverse.sqrt()).max(-kMostDeviations).min(kMostDeviations),
                      now.surprise.min(kFarSquare), (second_ / kOtherNoise).max(1.0), 2.0 * rarity,
                      logarithm(now.rest_factor)};
  coloured_ = greatest(colour) > kColoured;
  age_ += 1.0;
  unseen_.setZero();
  widest_.setOnes();
  suspected_ = false;
  std::optional<std::size_t> found;
  double most = 0.0;
  for (std::size_t j = 0; j < trackers.size(); ++j) {
    contest(trackers, j, now, common, colour);
    const Contest& c = contest_[j];
    if (!(greatest(c.ratio) > 0.5 * kEvidence)) continue;
    suspected_ = true;
    for (Eigen::Index a = 0; a < kMaxAxes; ++a) {
      const double same = same_size(c, a) / c.divisor[a], over = c.ratio[a] - kEvidence;
      if (over <= most || same <= logarithm(lag)) continue;
      most = over;
      found = j;
    }
  }
  // Tails and colour make large innovations come together. If all are larger than the known noise, that is motion.
  seen_ = std::min(seen_ + 1.0, kTailMemory);
  const Lanes tails = (fourth_ / (3.0 * common.louder.square())).max(1.0);
  const Lanes larger = (0.5 - 0.5 / kShakingVariance) * (now.surprise / widest_).min(common.cap);
  shaking_ = (shaking_ + now.mask * (larger - std::numbers::ln2 / widest_) / tails).max(0.0);
  fourth_ += now.mask * (capped * capped - fourth_) / seen_;
  second_ += now.mask * (capped - second_) / seen_;
  if (!found && greatest(shaking_) > kEvidence) found = kShaking;
  return found;
}

// A filter of gain k leaves k R / (r + k) of noise of correlation rate r. Its innovations, summed over 1 / b, are
// 2 b r / ((r + k) (r + b) (k + b)) of R, and the walk's part k / (k + b) of the rule's R more. So b / (k + b) over the
// noise's part is a straight line in b, of which the end at zero is wanted.
Lanes ChangeTest::wide(const Trackers& trackers, double lag, double rule) const noexcept {
  Lanes wide = Lanes::Ones(), inverse_before = Lanes::Zero();
  if (!coloured_) return wide;
  const double k = 1.0 / (1.0 + lag);
  double before = 0.0;
  for (std::size_t j = 0; j < trackers.size() && (j <= 1 || trackers.horizon(j) <= 2.0 * lag); ++j) {
    const double b = 1.0 / trackers.horizon(j), both = k + b;
    const Lanes inverse = b / (both * (contest_[j].wide - rule * k / both).max(0.1 * b / both));
    const double ahead = before > b ? b / (before - b) : 0.0;
    wide = 1.0 / (rule * (inverse - ahead * (inverse_before - inverse)).max(0.25 * inverse));
    before = b;
    inverse_before = inverse;
  }
  return wide;
}

}  // namespace ifog
