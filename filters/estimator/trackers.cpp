// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/trackers.h"

#include <algorithm>
#include <cmath>

#include "filters/random/log_exp.h"

namespace ifog {
namespace {

// Half a decade between memories: the mix of two neighbours is within 5 % of the best memory between them.
constexpr double kSpacing = 3.1622776601683795;
// Memory, samples, of the second one: half of the raw measurement's weight. Shorter ones differ from that by
// nothing.
constexpr double kSecond = 4.5;
// A parabola is prolonged over so many of its lengths at most: beyond, its variance exceeds a thousand times
// R.
constexpr double kMostLengths = 4.0;
// Samples over which the usual distance between measurements is averaged.
constexpr double kUsualMemory = 32.0;
// The shortest four follow any motion that 200 samples show, whatever the filter at rest is.
constexpr std::size_t kAlways = 4;

Trackers::Gains fading_gains(double memory) {
  const double m = 1.0 / memory, th = 1.0 - m, p = 1.0 + th, g = 1.0 - th * th * th;
  const double ahead = m / (p * p * p * p * p) * (19.0 + th * (24.0 + th * (16.0 + th * (6.0 + th))));
  return {g,           1.5 * m * m * p,        0.5 * m * m * m,
          1.0 + ahead, logarithm(1.0 + ahead), (1.0 - g) * (1.0 - g) * ahead + g * g};
}

}  // namespace

Trackers::Trackers(std::size_t axes) noexcept : axes_(axes) {
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
}

void Trackers::grow_to(State& state, std::size_t j, double age) const noexcept {
  state.age = age;
  state.length = std::min(memory_[j], age / 3.0 + 1.0);
  state.settled = false;
}

void Trackers::begin_from(std::size_t tracker, std::size_t from) noexcept {
  // As old as what it starts from is long: the parabola through so many measurements.
  const double age = std::max(kParabola, state_[from].length);
  const std::size_t end = std::max(size_, tracker + 1);
  for (std::size_t j = tracker; j < end; ++j) {
    state_[j] = state_[from];
    grow_to(state_[j], j, age);
    set_gains(state_[j], j);
  }
}

// Gains of the growing-memory filter until the fading ones are larger. The first two are a point and a line.
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

// An axis that has been missing for longer than its parabola reaches keeps the rate at which that ended.
void Trackers::prolong(State& state, double steps) const noexcept {
  for (Eigen::Index a = 0; a < kMaxAxes; ++a) {
    if (since_[a] > kMostLengths * state.length * usual_[a]) state.slope[a] = state.curvature[a] = 0.0;
    state.rate[a] += steps * (state.slope[a] + steps * state.curvature[a]);
    state.slope[a] += 2.0 * steps * state.curvature[a];
  }
}

[[gnu::flatten]] void Trackers::predict(double steps) noexcept {
  since_ += steps;
  bool whole = even_ && steps == 1.0;
  for (std::size_t a = 0; a < axes_; ++a) whole = whole && since_[static_cast<Eigen::Index>(a)] == 1.0;
  for (std::size_t j = 0; j < size_; ++j) {
    State& state = state_[j];
    if (!state.settled) set_gains(state, j);
    if (!whole) {
      prolong(state, steps);
      continue;
    }
    state.rate += state.slope + state.curvature;
    state.slope += 2.0 * state.curvature;
  }
}

[[gnu::flatten]] void Trackers::correct(const Lanes& rate, std::uint32_t valid_axes) noexcept {
  even_ = (axes_of_sensor(axes_) & ~valid_axes) == 0;
  for (Eigen::Index a = 0; a < static_cast<Eigen::Index>(axes_); ++a)
    even_ = even_ && since_[a] == 1.0 && usual_[a] == 1.0;
  for (std::size_t j = 0; j < size_; ++j) {
    State& state = state_[j];
    const Gains& g = state.gains;
    if (even_) {
      const Lanes innovation = rate - state.rate;
      state.rate += g.rate * innovation;
      state.slope += g.slope * innovation;
      state.curvature += g.curvature * innovation;
    } else {
      correct_some(state, rate, valid_axes);
    }
    state.age += 1.0;
    if (!state.settled) state.length = std::min(memory_[j], state.age / 3.0 + 1.0);
  }
  for (Eigen::Index a = 0; a < kMaxAxes; ++a) {
    if ((valid_axes >> a & 1U) == 0) continue;
    usual_[a] += (std::min(since_[a], kUsualMemory) - usual_[a]) / kUsualMemory;
    if (std::abs(usual_[a] - 1.0) < 1e-3) usual_[a] = 1.0;
    since_[a] = 0.0;
  }
}

// The gains are those of steps of one sample. In units of nominal samples those of slope and curvature fall
// with the distance of the measurements; left as they are, longer steps would put the poles outside the unit
// circle.
void Trackers::correct_some(State& state, const Lanes& rate, std::uint32_t valid_axes) noexcept {
  const Gains& g = state.gains;
  for (Eigen::Index a = 0; a < kMaxAxes; ++a) {
    if ((valid_axes >> a & 1U) == 0) continue;
    const double innovation = rate[a] - state.rate[a], step = std::max(since_[a], usual_[a]);
    // What a parabola that has ended holds is not corrected but begun again.
    const bool ended = since_[a] > kMostLengths * state.length * usual_[a];
    state.rate[a] += (ended ? 1.0 : g.rate) * innovation;
    state.slope[a] += ended ? 0.0 : g.slope / step * innovation;
    state.curvature[a] += ended ? 0.0 : g.curvature / (step * step) * innovation;
  }
}

// That of a parabola grows with the fourth power of how far it is prolonged, in lengths of what it goes
// through.
double Trackers::factor(std::size_t j, std::size_t axis) const noexcept {
  const State& state = state_[j];
  const double one = state.gains.factor, far = since(axis);
  if (far == 1.0 || state.age <= 0.0) return one;
  const double more = (state.length + far) / (state.length + 1.0), square = more * more;
  return 1.0 + (one - 1.0) * square * square;
}

void Trackers::seed(std::size_t axis, double rate) noexcept {
  const auto a = static_cast<Eigen::Index>(axis);
  for (State& state : state_) {
    state.rate[a] = rate;
    state.slope[a] = state.curvature[a] = 0.0;
  }
}

}  // namespace ifog
