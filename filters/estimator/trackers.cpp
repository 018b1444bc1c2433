// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/trackers.h"

#include <algorithm>
#include <cmath>

#include "filters/random/log_exp.h"

namespace ifog {
namespace {

// Memories half a decade apart: the mixture of two neighbours is within 5 % of the best memory between them.
constexpr double kSpacing = 3.1622776601683795;
// Memory of the second tracker, samples: it weighs the raw measurement by one half. Shorter ones would hardly
// differ from the raw measurement.
constexpr double kSecond = 4.5;
// The shortest four, which follow any motion over 200 samples, are always enabled.
constexpr std::size_t kAlways = 4;

Trackers::Gains fading_gains(double memory) {
  const double m = 1.0 / memory, th = 1.0 - m, p = 1.0 + th, g = 1.0 - th * th * th;
  const double ahead = m / (p * p * p * p * p) * (19.0 + th * (24.0 + th * (16.0 + th * (6.0 + th))));
  return {g,           1.5 * m * m * p,        0.5 * m * m * m,
          1.0 + ahead, logarithm(1.0 + ahead), (1.0 - g) * (1.0 - g) * ahead + g * g};
}

}  // namespace

Trackers::Trackers(std::size_t axes) noexcept : axes_(mask_of(axes_of_sensor(axes))) {
  for (std::size_t j = 0; j < kMost; ++j) {
    memory_[j] = j == 0 ? 1.0 : kSecond * std::pow(kSpacing, static_cast<double>(j - 1));
    horizon_[j] = std::max(5.0, 3.0 * memory_[j]);
    fading_[j] = fading_gains(memory_[j]);
  }
  size_ = kAlways;
}

void Trackers::reach(double samples) noexcept {
  for (; size_ < kMost && memory_[size_] <= samples; ++size_) begin_from(size_, size_ - 1);
}

void Trackers::begin() noexcept {
  for (State& state : state_) state = {};
  since_.setZero();
  stride_.setOnes();
}

void Trackers::grow_to(State& state, std::size_t j, double age) const noexcept {
  state.age = age;
  state.length = std::min(memory_[j], age / 3.0 + 1.0);
  state.settled = false;
}

void Trackers::begin_from(std::size_t tracker, std::size_t from) noexcept {
  // Age equal to the other's length: parabola through as many measurements.
  const double age = std::max(kParabola, state_[from].length);
  const std::size_t end = std::max(size_, tracker + 1);
  for (std::size_t j = tracker; j < end; ++j) {
    state_[j] = state_[from];
    grow_to(state_[j], j, age);
    set_gains(state_[j], j);
  }
}

// Gains of the growing-memory filter until the fading-memory gains are larger. The first two are a point and
// a line.
void Trackers::set_gains(State& state, std::size_t j) const noexcept {
  const double n = state.age;
  if (n < 2.0) {
    state.gains = {};
    state.gains.slope = n;
    return;
  }
  const double product = (n + 1.0) * (n + 2.0) * (n + 3.0), g = 3.0 * (3.0 * n * n + 3.0 * n + 2.0) / product;
  if (g <= fading_[j].rate) {
    state.settled = true;
    state.gains = fading_[j];
    return;
  }
  const double factor = g < 1.0 ? 1.0 / (1.0 - g) : kUnknown;
  state.gains = {g, 18.0 * (2.0 * n + 1.0) / product, 30.0 / product, factor, logarithm(factor), g};
}

// An axis that is missing for longer than the parabola's reach keeps the last extrapolated rate.
void Trackers::prolong(State& state, double steps) const noexcept {
  state.slope = ended(state).select(0.0, state.slope);
  state.curvature = ended(state).select(0.0, state.curvature);
  state.rate += steps * (state.slope + steps * state.curvature);
  state.slope += 2.0 * steps * state.curvature;
}

[[gnu::flatten]] void Trackers::predict(double steps) noexcept {
  since_ += steps;
  const bool whole = steps == 1.0 && all_since_last();
  for (std::size_t j = 0; j < size_; ++j) {
    State& state = state_[j];
    if (steps >= 2.0 && steps > memory_[j]) {  // little of it is left
      state.slope = state.curvature = Lanes::Zero();
      grow_to(state, j, 0.0);
    }
    if (!state.settled) set_gains(state, j);
    if (!whole) {
      prolong(state, steps);
      continue;
    }
    state.rate += state.slope + state.curvature;
    state.slope += 2.0 * state.curvature;
  }
}

[[gnu::flatten]] void Trackers::correct(const Lanes& rate, const Lanes& mask) noexcept {
  const bool whole = all_since_last() && (axes_ * (1.0 - mask)).sum() == 0.0;
  for (std::size_t j = 0; j < size_; ++j) {
    State& state = state_[j];
    const Gains& g = state.gains;
    if (whole) {
      const Lanes innovation = rate - state.rate;
      state.rate += g.rate * innovation;
      state.slope += g.slope * innovation;
      state.curvature += g.curvature * innovation;
    } else {
      correct_some(state, rate, mask);
    }
    state.age += 1.0;
    if (!state.settled) state.length = std::min(memory_[j], state.age / 3.0 + 1.0);
  }
  stride_ = whole ? Lanes::Ones() : (mask > 0.0).select(since_, stride_).eval();
  since_ *= 1.0 - mask;
}

// The gains after a step of s samples are those of pole theta^s: weights fade with time, so the filter is stable
// for any pattern of gaps. With the gains of one sample it is not.
void Trackers::correct_some(State& state, const Lanes& rate, const Lanes& mask) noexcept {
  const Gains& g = state.gains;
  const Lanes innovation = mask * (rate - state.rate), step = since_.max(1.0);
  Lanes first = Lanes::Constant(g.rate), second = Lanes::Constant(g.slope),
        third = Lanes::Constant(g.curvature);
  for (Eigen::Index a = 0; a < kMaxAxes; ++a) {
    if (mask[a] == 0.0 || step[a] < 2.0 || state.age < kParabola || state.length <= 1.0) continue;
    const double th = exponential(step[a] * logarithm(1.0 - 1.0 / state.length)), m = 1.0 - th;
    first[a] = 1.0 - th * th * th;
    second[a] = 1.5 * m * m * (1.0 + th);
    third[a] = 0.5 * m * m * m;
  }
  // After the end of its extrapolation a parabola restarts instead of being corrected.
  state.rate += ended(state).select(innovation, first * innovation);
  state.slope += ended(state).select(0.0, second / step * innovation);
  state.curvature += ended(state).select(0.0, third / (step * step) * innovation);
}

// The variance of a parabola grows with the fourth power of its reach.
Lanes Trackers::factor(std::size_t j) const noexcept {
  const State& state = state_[j];
  const double one = state.gains.factor;
  if (state.age <= 0.0 || all_since_last()) return Lanes::Constant(one);
  return 1.0 + (one - 1.0) * reach(j).square().square();
}

void Trackers::seed(const Lanes& rate, const Lanes& mask) noexcept {
  for (State& state : state_) {
    state.rate = (mask > 0.0).select(rate, state.rate);
    state.slope = (mask > 0.0).select(0.0, state.slope);
    state.curvature = (mask > 0.0).select(0.0, state.curvature);
  }
}

}  // namespace ifog
