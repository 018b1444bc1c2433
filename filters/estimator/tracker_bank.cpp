// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/tracker_bank.h"

#include <algorithm>
#include <cmath>

#include "filters/random/log_exp.h"

namespace ifog {
namespace {

// The shortest is the measurement itself: theta = 0. The next has theta = 0.3.
constexpr double kShortest = 1.0 / 0.7;
const double kPaceRatio = std::sqrt(10.0);
// A motion is looked for over this many samples at least, however short the filter at rest is.
constexpr double kLeastReach = 48.0;
// A parabola is prolonged by so many lengths of what it goes through: behind them, whatever it was that it
// followed, it is further off than what was measured last.
constexpr double kMostLengths = 2.0;
// An axis that has not come for so many samples makes the trackers no younger.
constexpr double kGone_samples = 16.0;
// Lengths that the steepness of a motion is a mean over: enough of them for a swing that the tracker follows.
constexpr double kSteepness = 16.0;
// Measurements, at least, that a mean of their distances is taken of.
constexpr double kLeastMean = 2.0;
// Innovation variance over the noise's of a tracker that has not enough measurements for a parabola.
constexpr double kUnknown = 1e6;

}  // namespace

TrackerBank::TrackerBank(std::size_t axes) : axes_(axes) {
  memory_[0] = 1.0;
  for (std::size_t j = 1; j < kMost; ++j) memory_[j] = j == 1 ? kShortest : memory_[j - 1] * kPaceRatio;
  for (std::size_t j = 0; j < kMost; ++j) {
    const double theta = 1.0 - 1.0 / memory_[j], m = 1.0 / memory_[j];
    Gains& g = fading_[j];
    g.rate = 1.0 - theta * theta * theta;
    g.slope = 1.5 * m * m * (1.0 + theta);
    g.curvature = 0.5 * m * m * m;
    // Variance one sample ahead, Brookner's table 7.2-2.
    const double plus = 1.0 + theta, plus2 = plus * plus;
    const double ahead =
        m / (plus2 * plus2 * plus) * (19.0 + theta * (24.0 + theta * (16.0 + theta * (6.0 + theta))));
    g.innovation = 1.0 + ahead;
    g.log_innovation = logarithm(g.innovation);
    g.output = (1.0 - g.rate) * (1.0 - g.rate) * ahead + g.rate * g.rate;
  }
  begin();
  reach(0.0);
}

void TrackerBank::reach(double samples) noexcept {
  const double longest = std::max(kLeastReach, samples);
  while (size_ < kMost && memory_[size_] <= longest) {
    state_[size_] = {};
    if (size_ > 0) state_[size_] = state_[size_ - 1];
    state_[size_].settled = false;
    grow_to(size_, state_[size_].age);
    gains(size_++);
  }
}

void TrackerBank::begin() noexcept {
  for (State& state : state_) state = {};
  steps_.setZero();
  measured_ = 0;
}

void TrackerBank::begin(std::span<const Axes> measurements) noexcept {
  begin();
  for (const Axes& rate : measurements) {
    predict(1.0);
    correct(rate, ~0U);
  }
}

void TrackerBank::begin_from(std::size_t tracker, std::size_t from) noexcept {
  for (std::size_t j = tracker; j < size_; ++j) {
    state_[j] = state_[from];
    // As old as what it starts from has memory: the parabola through so many.
    grow_to(j, std::max(3.0, length(from)));
    state_[j].settled = false;
  }
}

void TrackerBank::grow_to(std::size_t tracker, double age) noexcept {
  state_[tracker].age = age;
  state_[tracker].length = std::min(memory_[tracker], age / 3.0 + 1.0);
}

double TrackerBank::farthest(std::size_t tracker, std::size_t axis) const noexcept {
  const State& state = state_[tracker];
  return kMostLengths * state.length * state.usual_step[static_cast<Eigen::Index>(axis)];
}

inline bool TrackerBank::too_far(const State& state) const noexcept {
  const double lengths = kMostLengths * state.length;
  for (Eigen::Index a = 0; a < static_cast<Eigen::Index>(axes_); ++a)
    if (steps_[a] > lengths * state.usual_step[a]) return true;
  return false;
}

// Gains of the growing-memory filter until the fading ones are larger. The first two steps are a point and a
// line.
[[gnu::noinline]] void TrackerBank::gains(std::size_t tracker) noexcept {
  State& state = state_[tracker];
  Gains& now = now_[tracker];
  if (state.settled) return;
  const double n = state.age;
  if (n < 2.0) {
    now = {1.0, n, 0.0, kUnknown, logarithm(kUnknown), 1.0};
    return;
  }
  const double product = (n + 1.0) * (n + 2.0) * (n + 3.0);
  const double rate = 3.0 * (3.0 * n * n + 3.0 * n + 2.0) / product;
  if (rate <= fading_[tracker].rate) {
    state.settled = true;
    now = fading_[tracker];
    return;
  }
  const double factor = rate < 1.0 ? 1.0 / (1.0 - rate) : kUnknown;
  now = {rate, 18.0 * (2.0 * n + 1.0) / product, 30.0 / product, factor, logarithm(factor), rate};
}

[[gnu::flatten]] void TrackerBank::predict(double steps) noexcept {
  steps_ += steps;
  for (std::size_t j = 0; j < size_; ++j) {
    State& state = state_[j];
    if (too_far(state)) [[unlikely]] {
      prolong_some(j, steps);
    } else {
      state.rate += steps * (state.slope + steps * state.curvature);
      state.slope += 2.0 * steps * state.curvature;
    }
    if (!state.settled) gains(j);
  }
}

// Where an axis has been missing for longer than the tracker is prolonged.
[[gnu::cold, gnu::noinline]] void TrackerBank::prolong_some(std::size_t tracker, double steps) noexcept {
  State& state = state_[tracker];
  bool foresees = false;
  for (std::size_t axis = 0; axis < axes_; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    if (steps_[a] > farthest(tracker, axis)) {
      state.rate[a] = state.filtered[a];
      state.slope[a] = state.curvature[a] = 0.0;
      continue;
    }
    foresees = true;
    state.rate[a] += steps * (state.slope[a] + steps * state.curvature[a]);
    state.slope[a] += 2.0 * steps * state.curvature[a];
  }
  if (foresees) return;
  grow_to(tracker, 0.0);
  state.settled = false;
}

[[gnu::flatten]] void TrackerBank::correct(const Axes& rate, std::uint32_t valid_axes) noexcept {
  const std::uint32_t missed = measured_ & ~valid_axes;
  bool whole = true;
  for (std::size_t a = 0; missed != 0 && a < kMaxAxes; ++a)
    whole = whole && ((missed >> a & 1U) == 0 || since(a) > kGone_samples);
  measured_ |= valid_axes;
  const bool all = (axes_of_sensor(axes_) & ~valid_axes) == 0;
  Lanes measured = Lanes::Zero();
  bool even = true;
  for (std::size_t a = 0; a < axes_; ++a) {
    measured[static_cast<Eigen::Index>(a)] = rate[a];
    even = even && since(a) == 1.0;
  }
  for (std::size_t j = 0; j < size_; ++j) {
    State& state = state_[j];
    if (all && !too_far(state))
      correct_all(j, measured, even);
    else
      correct_some(j, rate, valid_axes);
    if (!whole) continue;
    state.age += 1.0;
    if (state.length < memory_[j]) state.length = std::min(memory_[j], state.age / 3.0 + 1.0);
  }
  for (std::size_t a = 0; a < kMaxAxes; ++a)
    if ((valid_axes >> a & 1U) != 0) steps_[static_cast<Eigen::Index>(a)] = 0.0;
}

inline void TrackerBank::correct_all(std::size_t tracker, const Lanes& rate, bool even) noexcept {
  State& state = state_[tracker];
  const Gains& g = now_[tracker];
  const Lanes innovation = rate - state.rate;
  state.rate += g.rate * innovation;
  state.filtered = state.rate;
  if (even && state.even) {
    state.slope += g.slope * innovation;
    state.curvature += g.curvature * innovation;
  } else {
    state.even = false;
    Lanes& usual = state.usual_step;
    usual += (steps_ - usual) / std::max(kLeastMean, std::min(memory_[tracker], state.age));
    const Lanes step = steps_.max(usual);
    state.slope += g.slope / step * innovation;
    state.curvature += g.curvature / (step * step) * innovation;
  }
  state.slope_square += (state.slope * state.slope - state.slope_square) / (kSteepness * state.length);
}

[[gnu::cold, gnu::noinline]] void TrackerBank::correct_some(std::size_t tracker, const Axes& rate,
                                                            std::uint32_t valid_axes) noexcept {
  State& state = state_[tracker];
  const Gains& g = now_[tracker];
  state.even = false;
  for (std::size_t axis = 0; axis < axes_; ++axis) {
    if ((valid_axes >> axis & 1U) == 0) continue;
    const auto a = static_cast<Eigen::Index>(axis);
    // Prolonged no further than that, what is left of its parabola is not to be corrected but begun again.
    double& usual = state.usual_step[a];
    if (steps_[a] > farthest(tracker, axis)) {
      state.rate[a] = state.filtered[a] = rate[axis];
      usual = std::min(steps_[a], kGone_samples);
      continue;
    }
    usual += (steps_[a] - usual) / std::max(kLeastMean, std::min(memory_[tracker], state.age));
    const double innovation = rate[axis] - state.rate[a];
    const double step = std::max(steps_[a], usual);
    state.rate[a] += g.rate * innovation;
    state.filtered[a] = state.rate[a];
    state.slope[a] += g.slope / step * innovation;
    state.curvature[a] += g.curvature / (step * step) * innovation;
    state.slope_square[a] +=
        (state.slope[a] * state.slope[a] - state.slope_square[a]) / (kSteepness * state.length);
  }
}

// That of a parabola grows with the fourth power of how far it is prolonged, in lengths of what it goes
// through; the factor between a parabola through three measurements (1.2) and through many (0.8).
double TrackerBank::growth(std::size_t tracker, std::size_t axis) const noexcept {
  constexpr double kPerLength = 0.9;
  if (state_[tracker].age <= 0.0) return 1.0;  // it foresees nothing, and its factor says so
  const double n = length(tracker) / kPerLength;
  const double more = (n + since(axis)) / (n + 1.0), square = more * more;
  return square * square;
}

void TrackerBank::pass_over() noexcept {
  for (std::size_t j = 0; j < size_; ++j) {
    state_[j].slope *= 0.5;
    state_[j].curvature.setZero();
  }
}

}  // namespace ifog
