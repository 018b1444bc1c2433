// SPDX-License-Identifier: Apache-2.0
// What the engine hears of the noise: under way, at rest, and by how much it has become louder since.
#include <algorithm>
#include <bit>
#include <cmath>

#include "filters/estimator/engine.h"

namespace ifog {
namespace {

// After so many samples that nobody has measured, what is rough by the next one is no noise.
constexpr double kMostSteps = 16.0;
// Times the R that was learned: less is the roughness' own error, and what learning is for.
constexpr double kLouder = 2.0;

}  // namespace

// The noise under way, whether the sensor moves or not.
void Engine::hear(const Measurement& m) noexcept {
  // Scaled alike, the rate itself is none of a third difference; scaled differently it is all of it.
  const bool alike = m.noise_scale == heard_scale_;
  heard_scale_ = m.noise_scale;
  for (std::size_t a = 0; a < axes_; ++a) {
    unheard_s_[a] += m.dt_s;
    if (!alike) noise_[a].break_off();
    if (!has(m.valid, a)) continue;
    const bool next = unheard_s_[a] == period_s_;
    const double steps = next ? 1.0 : std::max(1.0, std::round(unheard_s_[a] / period_s_));
    if (steps > kMostSteps) noise_[a].break_off();
    noise_[a].take(m.in.rate_radps[a] * m.to_nominal, steps);
    unheard_s_[a] = 0.0;
  }
}

void Engine::learn_noise(const Measurement& m, std::uint32_t of) noexcept {
  bool all = m.valid != 0;
  double rest = 0.0, greatest = 0.0;
  const double lag = lag_samples();
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!has(m.valid, a)) continue;
    if (has(of, a))
      noise_[a].learn(m.innovation[a] * m.to_nominal, lag, noise_[a].known() ? 0.0 : foresight_[a].least());
    all = all && noise_[a].known();
    rest += noise_[a].rest();
    greatest += noise_[a].greatest_noise();
  }
  if (steady_ == nullptr || !all) return;
  const double axes = std::popcount(m.valid);
  if (knowledge_ != Knowledge::heard) steady_->begin(rest / axes, kRestMemory);
  knowledge_ = Knowledge::heard;
  steady_->limit(greatest / axes);
  for (std::size_t a = 0; a < axes_; ++a)
    if (has(m.valid, a) && rest > 0.0) loudness_[a] = noise_[a].rest() * axes / rest;
}

// Of those measured now and of all together: R is a mean of what both have been, and where the axes are
// unlike, one of them alone is louder than the mean without having become so.
double Engine::louder_by(std::uint32_t valid) const noexcept {
  double measured = 0.0, all = 0.0;
  for (std::size_t a = 0; a < axes_; ++a) {
    if (!has(started_, a) || !noise_[a].known()) continue;
    const double noise = noise_[a].greatest_noise();
    all += noise;
    if (has(valid, a)) measured += noise;
  }
  const double ratio = std::min(measured / std::popcount(valid), all / std::popcount(started_)) /
                       rest_->rule().measurement_noise();
  return ratio > kLouder ? ratio : 1.0;
}

// Variance of the rate predicted at rest: what the filter told itself last, until the noise was heard.
void Engine::average_rest(double predicted) noexcept {
  rest_variance_ += (knowledge_ == Knowledge::heard ? 1.0 / kRestMemory : 1.0) * (predicted - rest_variance_);
}

}  // namespace ifog
