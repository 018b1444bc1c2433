// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/change_test.h"

#include <algorithm>
#include <cmath>

#include "filters/random/log_exp.h"

namespace ifog {
namespace {

constexpr double kMemories = 3.0;
constexpr double kLeastHorizon = 5.0;
// Share of the evidence for a change that makes one suspected.
constexpr double kSuspicion = 0.5;
// A sum of innovations two of its standard deviations from zero is a sign that a change may have begun. What
// a motion adds to the mean normalised square of the filter's error until it is suspected depends on this
// alone, not on how it begins: the evidence against rest is itself the sum of the squares of that error. Over
// five horizons there is such a sum in a tenth of the time at rest; over more it is to be no more often, and
// more is asked for: of any of n sums it is about n times as likely. Lately there was motion: less is needed,
// by as much as for a change. In a ramp, which sums over half of its age show best, the filter is off by 1.8
// times their mean.
constexpr double kUnseen = 4.0;
constexpr double kUnseenSums = 5.0;
constexpr double kOffByMean = 3.1;
// Sums over fewer samples than this tracker's say no more than the single measurement, which has a test of
// its own.
constexpr std::size_t kShortestSum = 2;
// Least ratio: what speaks for rest must not delay what comes then.
constexpr double kLeast = -5.0;
// By how much less evidence is asked for after a motion, and for how long, samples.
constexpr double kRelaxed = 10.0;
constexpr double kRelaxedFor = 1000.0;
// Widenings are believed as found once they stand on ten horizons, and forgotten after
// a hundred and eighty.
constexpr double kHorizonsBelieved = 10.0;
constexpr double kHorizonsKept = 180.0;
// One sum counts for so many times what is known: a motion about to be found is no colour.
constexpr double kWideningClip = 16.0;
// Where they are used to tell how loud the filter's own rate is: up to so many of its lags, in coloured noise
// once they stand on so many horizons, with this part of white noise's at least, and followed to no more than
// four times what the longest shows.
constexpr double kWideLags = 2.0;
constexpr double kHorizonsKnown = 100.0;
constexpr double kLeastNoise = 0.1;
constexpr double kLeastFollowed = 0.25;
// Of what is clipped the mean is known from so many measurements at least: a change that is found leaves a
// few in it.
constexpr double kFewestClipped = 1024.0;
// What was found may have been this much too small.
constexpr double kWideningMargin = 1.25;
// Squares are known to this many measurements' worth before there are any.
constexpr double kPrior = 4.0;
constexpr double kSquareClip = 400.0;
// What a tracker gains on a wrong model with each measurement: before it was seen, and over how many horizons
// it is averaged then.
constexpr double kModelDoubt = 0.1;
constexpr double kUsualHorizons = 5.0;

}  // namespace

ChangeTest::ChangeTest(bool rate_alone, std::size_t axes)
    : rate_alone_(rate_alone), axes_(axes_of_sensor(axes)) {
  for (Contest& contest : contests_) contest.usual = rate_alone ? 0.0 : kModelDoubt;
}

ChangeTest::Horizon::Horizon(double length)
    : samples(length),
      share(1.0 / length),
      keep(1.0 - share),
      keep_square(keep * keep),
      evidence(kEvidence - logarithm(length / kLeastHorizon)) {}

double ChangeTest::horizon(double memory) noexcept { return std::max(kLeastHorizon, kMemories * memory); }

void ChangeTest::restart() noexcept {
  forget();
  relaxed_ = kRelaxed;
}

void ChangeTest::forget() noexcept {
  unseen_ = {};
  suspected_ = false;
  for (Contest& contest : contests_) {
    contest.ratio = contest.rest = contest.tracker = contest.rest_squares = 0.0;
    contest.sums.angle = contest.sums.normalised = contest.sums.weight = Lanes::Zero();
  }
}

inline ChangeTest::Measured ChangeTest::measured(const Surprise& now,
                                                 const std::array<NoiseScale, kMaxAxes>& noise,
                                                 double most) noexcept {
  const double log_rest = logarithm(now.rest_factor), farthest = std::sqrt(2.0 * most);
  const double longest = horizons_[known_ - 1].samples;
  Measured out;
  for (std::size_t a = 0; a < kMaxAxes; ++a) {
    if ((now.valid >> a & 1U) == 0) continue;
    const auto lane = static_cast<Eigen::Index>(a);
    const double rest = now.innovation[a] * now.innovation[a] / (now.rest_factor * now.scale[a]);
    out.used[lane] = 1.0;
    out.rate[lane] = now.rate[a];
    out.scale[lane] = now.scale[a];
    out.rest[lane] = rest;
    out.spoke_for_rest[lane] = std::min(rest, 2.0 * most) + log_rest;
    const double whole = now.innovation[a] / std::sqrt(now.scale[a]);
    const double part = std::clamp(whole, -farthest, farthest);
    // More than as much again is no tail of the noise.
    const double beyond = std::clamp(whole, -2.0 * farthest, 2.0 * farthest) - part;
    // Before the noise is known it may be a motion that it began in.
    if (noise[a].known()) {
      clipped_count_[a] = std::min(clipped_count_[a] + 1.0, kHorizonsKept * longest);
      clipped_[a] += (beyond - clipped_[a]) / std::max(clipped_count_[a], kFewestClipped);
    }
    out.normalised[lane] = part + clipped_[a];
    out.angle[lane] = now.innovation[a] * now.covered_s[a];
    out.rest_square += std::min(rest, kSquareClip);
  }
  return out;
}

// Learns how wide the sums are at rest.
inline void ChangeTest::Sums::add(const Measured& now, const Horizon& over) noexcept {
  angle = over.keep * angle + now.angle;
  normalised = over.keep * normalised + now.normalised;
  weight = over.keep_square * weight + 1.0;
  const Lanes found = normalised * normalised / weight;
  horizons = (horizons + over.share).min(kHorizonsKept);
  widening += (found.min(kWideningClip * widening.max(1.0)) - widening) / (over.samples * (horizons + 1.0));
}

void ChangeTest::Sums::keep(const Sums& before, Eigen::Index axis) noexcept {
  angle[axis] = before.angle[axis];
  normalised[axis] = before.normalised[axis];
  weight[axis] = before.weight[axis];
  widening[axis] = before.widening[axis];
  horizons[axis] = before.horizons[axis];
}

inline void ChangeTest::add(const Measured& now, const Horizon& over, std::uint32_t valid,
                            Sums& sums) const noexcept {
  if ((axes_ & ~valid) == 0)
    sums.add(now, over);
  else
    add_some(now, over, valid, sums);
}

// Of an axis that is not measured they stay as they are.
[[gnu::cold, gnu::noinline]] void ChangeTest::add_some(const Measured& now, const Horizon& over,
                                                       std::uint32_t valid, Sums& sums) const noexcept {
  const Sums before = sums;
  sums.add(now, over);
  for (std::size_t a = 0; a < kMaxAxes; ++a)
    if ((valid >> a & 1U) == 0) sums.keep(before, static_cast<Eigen::Index>(a));
}

[[gnu::noinline]] Lanes ChangeTest::wide(const Sums& sums, const Horizon& over, std::uint32_t coloured,
                                         const std::array<NoiseScale, kMaxAxes>& noise) noexcept {
  Lanes out = Lanes::Ones();
  for (std::size_t a = 0; a < kMaxAxes; ++a) {
    if ((coloured >> a & 1U) == 0) continue;
    // Of coloured noise nothing known yet: all that is not rough may be as slow as the horizon.
    const auto lane = static_cast<Eigen::Index>(a);
    const double most = std::max(1.0, over.samples * (1.0 - 1.0 / noise[a].colour()));
    out[lane] = kWideningMargin * std::max(1.0, believed(sums, lane, most));
  }
  return out;
}

inline double ChangeTest::unusual() const noexcept { return std::max(0.0, behind_.unseen - relaxed_); }

// Over the scale: the mean square of what the filter may be off by. square: of the sums, beyond the limit in
// one of them at least.
[[gnu::noinline]] void ChangeTest::see(const Sums& sums, const Surprise& now, const Lanes& square,
                                       const Lanes& limit) noexcept {
  for (std::size_t a = 0; a < kMaxAxes; ++a) {
    const auto lane = static_cast<Eigen::Index>(a);
    const double weight = sums.weight[lane];
    if ((now.valid >> a & 1U) == 0 || !(square[lane] > limit[lane]) ||
        square[lane] <= unusual() * believed(sums, lane) * weight)
      continue;
    unseen_[a] = std::max(unseen_[a], now.scale[a] * (kOffByMean * square[lane] / (2.0 * weight * weight)));
  }
}

// Log-likelihood ratio of two predictors of unknown variance: n/2 times the logarithm of the ratio of their
// mean squares, n the number of measurements that the squares of the worse one come from.
[[gnu::noinline]] double ChangeTest::unknown_variance(const Contest& contest) noexcept {
  if (!(contest.rest_squares > 0.0)) return 0.0;
  const double samples = contest.rest * contest.rest / contest.rest_squares;
  return 0.5 * samples * logarithm((kPrior + contest.rest) / (kPrior + contest.tracker));
}

// What it calls for each tracker in it: sums that go through memory would be waited for.
[[gnu::flatten]] std::optional<std::size_t> ChangeTest::take(const TrackerBank& trackers, const Surprise& now,
                                                             const std::array<NoiseScale, kMaxAxes>& noise,
                                                             double most, double lag) noexcept {
  relaxed_ *= 1.0 - 1.0 / kRelaxedFor;
  double greatest = 0.0;
  suspected_ = false;
  unseen_ = {};
  std::optional<std::size_t> best;
  for (; known_ < trackers.size(); ++known_) horizons_[known_] = Horizon(horizon(trackers.memory(known_)));
  look_behind(trackers, lag);
  const Measured all = measured(now, noise, most);
  std::uint32_t coloured = 0;
  for (std::size_t a = 0; a < kMaxAxes; ++a)
    if ((now.valid >> a & 1U) != 0 && !noise[a].white()) coloured |= 1U << a;
  const double rest_square = all.rest_square, seen = unusual();
  for (std::size_t j = 0; j < trackers.size(); ++j) {
    Contest& contest = contests_[j];
    const Horizon& over = horizons_[j];
    const double h = over.samples, keep = over.keep;
    const Lanes apart = all.used * (all.rate - trackers.rates(j));
    const Lanes tracker = apart * apart / (trackers.factor(j) * all.scale);
    add(all, over, now.valid, contest.sums);
    const Lanes wider = coloured == 0 ? Lanes(Lanes::Ones()) : wide(contest.sums, over, coloured, noise);
    // On a model with more states a mean of the innovations is the model's as often as a motion's.
    if (rate_alone_ && j >= kShortestSum && h <= kWideLags * lag) {
      const Lanes square = contest.sums.normalised * contest.sums.normalised;
      const Lanes limit = seen * wider * contest.sums.weight;
      if ((square - limit).maxCoeff() > 0.0) see(contest.sums, now, square, limit);
    }
    Lanes spoken = 0.5 * (all.spoke_for_rest - tracker.min(2.0 * most) - trackers.log_factor(j) * all.used);
    if (coloured != 0) spoken /= wider;
    const Lanes clipped = tracker.min(kSquareClip);
    double gained = sum_of_axes(spoken);
    const double tracker_square = sum_of_axes(clipped), widest = coloured != 0 ? wider.maxCoeff() : 1.0;
    if (!rate_alone_) {
      contest.usual += (std::clamp(gained, -1.0, 1.0) - contest.usual) / (kUsualHorizons * h);
      gained -= std::max(contest.usual, 0.0);
    }
    contest.ratio = std::max(keep * contest.ratio + gained, kLeast);
    contest.rest = keep * contest.rest + rest_square;
    contest.tracker = keep * contest.tracker + tracker_square;
    contest.rest_squares = keep * contest.rest_squares + rest_square * rest_square;
    const double whole = over.evidence, asked = whole - relaxed_;
    if (contest.ratio <= kSuspicion * whole && contest.ratio - asked <= greatest) continue;
    const double unknown = unknown_variance(contest) / widest;
    suspected_ = suspected_ || std::min(contest.ratio, unknown) > kSuspicion * whole;
    if (contest.ratio - asked <= greatest) continue;
    // That noise has become louder is the likelier, the less often the rate changes beside the filter's lag.
    if (unknown <= logarithm(std::max(lag, 1.0))) continue;
    greatest = contest.ratio - asked;
    best = j;
  }
  return best;
}

// Of noise that neighbours have in common the sums of innovations over a short time are narrower than its
// mean is wide, and over a long time the filter takes part in them. Its gain be K, the walk's driving noise
// K^2 of `share`, and the sums forget with b: of the noise S(w) alone they hold
//   f(b) = int w^2 S / ((w^2 + K^2)(w^2 + b^2)) dw,
// and K^2 f(0) is what the filter's rate has of it. For noise of one correlation time 1/a, white noise at its
// end, f(b) is as 1 / ((K + b)(a + b)), so that 1 / ((K + b) f(b)) is a straight line in b: of two horizons
// that are well known it is followed to b = 0.
double ChangeTest::coloured(const TrackerBank& trackers, std::size_t axis, double lag,
                            double share) const noexcept {
  const auto lane = static_cast<Eigen::Index>(axis);
  const double gain = 1.0 / (1.0 + lag);
  double b = 0.0, inverse = 0.0, at_zero = 0.0;
  for (std::size_t j = 1; j < trackers.size(); ++j) {
    const double h = horizon(trackers.memory(j));
    const Sums& sums = contests_[j].sums;
    if (j > 2 && (h > kWideLags * lag || sums.horizons[lane] < kHorizonsKnown)) break;
    const double here = 1.0 / h, both = gain + here;
    const double of_noise = std::max(sums.widening[lane] - share * gain / both, kLeastNoise * here / both);
    const double before = b, inverse_before = inverse;
    b = here;
    inverse = 2.0 * here / (of_noise * both);
    at_zero = before > here ? std::max(inverse - (inverse_before - inverse) * here / (before - here),
                                       kLeastFollowed * inverse)
                            : inverse;
  }
  return at_zero > 0.0 ? 2.0 / at_zero : 1.0;
}

void ChangeTest::look_behind(const TrackerBank& trackers, double lag) noexcept {
  if (lag == behind_.lag && trackers.size() == behind_.trackers) return;
  std::size_t longest = 1;
  while (longest + 1 < trackers.size() && horizon(trackers.memory(longest + 1)) <= kWideLags * lag) ++longest;
  const double sums = static_cast<double>(longest + 1) - static_cast<double>(kShortestSum);
  behind_ = {lag,
             trackers.size(),
             longest,
             1.0 / (1.0 + lag),
             1.0 / horizon(trackers.memory(longest)),
             kUnseen + 2.0 * logarithm(std::max(1.0, sums / kUnseenSums))};
}

// In white noise of variance 1 behind a gain K the innovations' sums, that forget with b, have of the noise
// b / (K + b) and of a walk of psi K^2 a sample psi K / (K + b). By what they are wider than that of the walk
// that is expected, it is more than that: nearly so where it is most of them, and less where the noise is,
// which outliers and slow motions widen, too.
double ChangeTest::walk(std::size_t axis, double expected) const noexcept {
  if (behind_.longest <= 1) return expected;
  const double gain = behind_.gain, b = behind_.forgets;
  const double before = (b + gain * expected) / (gain + b);
  const Sums& sums = contests_[behind_.longest].sums;
  return expected * believed(sums, static_cast<Eigen::Index>(axis), before) / before;
}

double ChangeTest::believed(const Sums& sums, Eigen::Index axis, double before) noexcept {
  const double horizons = sums.horizons[axis];
  return (kHorizonsBelieved * before + horizons * sums.widening[axis]) / (kHorizonsBelieved + horizons);
}

Wider ChangeTest::wider(const TrackerBank& trackers, std::size_t axis, double lag, const NoiseScale& noise,
                        const Wider& expected) noexcept {
  look_behind(trackers, lag);
  // What a model knows of colour is in its variance, and of its gain the rest does not hold.
  if (!rate_alone_) {
    const Sums& sums = contests_[behind_.longest].sums;
    const double found = std::max(1.0, believed(sums, static_cast<Eigen::Index>(axis)));
    return {behind_.longest > 1 ? found : 1.0, expected.walk};
  }
  if (noise.white()) return {1.0, walk(axis, expected.walk)};
  return {coloured(trackers, axis, lag, expected.noise * expected.walk), expected.walk};
}

}  // namespace ifog
