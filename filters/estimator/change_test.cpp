// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/change_test.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "filters/estimator/noise.h"
#include "filters/random/log_exp.h"

namespace ifog {
namespace {

// Variance of innovations in shaking, in R; half its logarithm is ln 2.
constexpr double kShakingVariance = 4.0;

}  // namespace

// Evidence from the sizes of the errors alone, with their effective number from the fourth moment.
double ChangeTest::same_size(const Contest& c, Eigen::Index a) const noexcept {
  return 0.5 * std::max(1.0, 1.0 / c.colour) * c.rest[a] * c.rest[a] / std::max(c.rest2[a], 1e-9) *
         logarithm((4.0 + c.rest[a]) / (4.0 + c.tracker[a]));
}

void ChangeTest::begin() noexcept {
  for (Contest& c : contest_)
    c.ratio = c.sum = c.weight = c.times = c.rest = c.rest2 = c.tracker = Lanes::Zero();
  forget_angle();
  shaking_.setZero();
  change_variance_.setZero();
  suspected_ = false;
  age_ = 0.0;
}

// Prior variance of an offset that raises R to kShakingVariance R: m / n of R, n the worth of a sum over the
// horizon. A sum of normalised square z^2 has the likelihood ratio exp(z^2 / 2 m / (m + 1)) / sqrt(m + 1).
ChangeTest::ChangeTest(const Trackers& trackers, const std::function<double(double)>& colour) {
  forget_angle();
  for (std::size_t j = 0; j < Trackers::kMost; ++j) {
    const double h = trackers.horizon(j), m = (kShakingVariance - 1.0) * h * h / (2.0 * h - 1.0);
    contest_[j].shrinks = 0.5 * m / (m + 1.0);
    contest_[j].spread = 0.5 * logarithm(m + 1.0);
    contest_[j].keep = 1.0 - 1.0 / h;
    contest_[j].worth = 1.0 / (2.0 * h - 1.0);
    contest_[j].colour = colour(contest_[j].keep);
  }
}

// Bayes: the prior probability of a change over the horizon is its average at this rest, to which a sum that contradicts
// one adds nothing.
void ChangeTest::expect(Contest& c, double h, const Lanes& nats, const Sample& now) noexcept {
  const Lanes square = now.scale * (c.sum / c.weight.max(1.0)).square();
  for (Eigen::Index a = 0; a < kMaxAxes; ++a) {
    if (!(now.mask[a] > 0.0)) continue;
    const double often = (0.5 * h + c.times[a]) / (h + age_), seldom = 1.0 - often;
    // exp(x) <= 1 / (1 - x) for x < 0: most samples need no exponential to show that they change nothing.
    if (nats[a] < 0.0 && often * square[a] <= change_variance_[a] * (1.0 - nats[a]) * seldom) continue;
    const double begun = often * exponential(std::min(nats[a], kEvidence)), likely = begun / (begun + seldom);
    if (nats[a] > 0.0) c.times[a] += likely;
    change_variance_[a] = std::max(change_variance_[a], likely * square[a]);
  }
}

void ChangeTest::contest(const Trackers& trackers, std::size_t j, const Sample& now,
                         const Common& common) noexcept {
  Contest& c = contest_[j];
  const Trackers::Gains& g = trackers.gains(j);
  const double h = trackers.horizon(j), keep = c.keep;
  const Lanes error = now.rate - trackers.rate(j);
  const Lanes mine = error * error * now.inverse * (1.0 / g.factor);
  c.sum = keep * c.sum + common.clipped;
  c.weight = keep * c.weight + now.mask;
  // Effective number of innovations in the sum: its variance / R.
  const Lanes n = (c.weight * (2.0 * h - c.weight) * c.worth).max(1.0);
  // Correlated neighbours count once, those that cancel each other, as of a dither, several times; the limit is the rarity
  // of an outlier.
  const Lanes alike = c.colour * colour_of_sum(now.decay, keep), share = now.mask / alike.max(1.0);
  const double times = std::max(1.0, 1.0 / c.colour);
  const Lanes evidence = 0.5 * times *
                         ((common.apart * share).min(common.cap) - (mine * share).min(common.cap) +
                          (common.log_rest - g.log_factor) * share);
  expect(c, h, c.shrinks * c.sum.square() / (n * alike * common.second) - c.spread, now);
  short_[j] = keep * short_[j] + now.short_rad;
  c.ratio = (keep * c.ratio + evidence).max(0.0);
  c.rest = keep * c.rest + common.squares;
  c.rest2 = keep * c.rest2 + common.squares.square();
  c.tracker = keep * c.tracker + mine.min(kFarSquare);
}

std::optional<std::size_t> ChangeTest::take(const Trackers& trackers, const Sample& now, double rarity,
                                            double lag) noexcept {
  const Lanes capped = now.surprise.min(2.0 * rarity);
  const double most = std::sqrt(2.0 * rarity);
  const Lanes apart = now.apart * now.apart * now.inverse * (1.0 / now.apart_factor);
  const Common common{(now.apart * now.inverse.sqrt()).max(-most).min(most),
                      apart,
                      apart.min(kFarSquare),
                      second_.max(1.0),
                      2.0 * rarity,
                      logarithm(now.apart_factor)};
  age_ += 1.0;
  change_variance_.setZero();
  suspected_ = false;
  std::optional<std::size_t> found;
  double furthest = 0.0;
  for (std::size_t j = 0; j < trackers.size(); ++j) {
    contest(trackers, j, now, common);
    const Contest& c = contest_[j];
    if (!(greatest(c.ratio) > 0.5 * kEvidence)) continue;
    suspected_ = true;
    for (Eigen::Index a = 0; a < kMaxAxes; ++a) {
      const double same = same_size(c, a), over = c.ratio[a] - kEvidence;
      if (over <= furthest || same <= logarithm(lag)) continue;
      furthest = over;
      found = j;
    }
  }
  // Tails and colour let large innovations coincide. If all exceed the known noise, it is motion.
  seen_ = std::min(seen_ + 1.0, kTailMemory);
  const Lanes tails = (fourth_ / (3.0 * (second_ / kOtherNoise).max(1.0).square())).max(1.0);
  const Lanes colour = colour_of_sum(now.decay, 1.0);
  const Lanes larger =
      (0.5 - 0.5 / kShakingVariance) * (now.surprise / (now.louder * colour)).min(common.cap);
  shaking_ = (shaking_ + now.mask * (larger - std::numbers::ln2 / colour) / tails).max(0.0);
  fourth_ += now.mask * (capped * capped - fourth_) / seen_;
  second_ += now.mask * (capped - second_) / seen_;
  if (!found && greatest(shaking_) > kEvidence) found = kShaking;
  return found;
}

}  // namespace ifog
