// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/noise.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace ifog::simulate {
namespace {

constexpr double kSpacing = 4.0;  // ratio of adjacent correlation times in the flicker sum

// An Ornstein–Uhlenbeck process of unit variance over a step of h correlation times. Given both end points,
// the mean over the step is Gaussian with mean mean_weight·(x₀ + x₁) and variance rest, independent of all
// else.
struct Step {
  double decay, drive, mean_weight, rest;
};

double variance_of_mean(double h) { return 2.0 * (h + std::expm1(-h)) / (h * h); }

Step step_of(double h) {
  Step s{};
  s.decay = std::exp(-h);
  s.drive = std::sqrt(-std::expm1(-2.0 * h));
  if (h < 1e-3) {  // the closed form is inaccurate here
    s.mean_weight = 0.5 * (1.0 - h * h / 12.0);
    s.rest = h / 6.0 - h * h * h / 90.0;
  } else {
    s.mean_weight = std::tanh(0.5 * h) / h;
    s.rest = std::max(0.0, variance_of_mean(h) - 2.0 * s.mean_weight * s.mean_weight * (1.0 + s.decay));
  }
  return s;
}

void check(const char* name, double value) {
  if (!std::isfinite(value) || value < 0.0)
    throw std::invalid_argument(std::string("noise ") + name + " is " + std::to_string(value) +
                                ", expected a finite number >= 0");
}

}  // namespace

GaussMarkov::GaussMarkov(double sigma, double correlation_s, double period_s, Draw draw) : draw_(draw) {
  const Step s = step_of(period_s / correlation_s);
  decay_ = s.decay;
  drive_ = sigma * s.drive;
  mean_weight_ = s.mean_weight;
  rest_ = sigma * std::sqrt(s.rest);
  state_ = sigma * draw_.normal();
}

double GaussMarkov::next() noexcept {
  const double before = state_;
  state_ = decay_ * state_ + drive_ * draw_.normal();
  return mean_weight_ * (before + state_) + rest_ * draw_.normal();
}

Flicker::Flicker(double B, double period_s, double duration_s, Draw draw) : draw_(draw) {
  if (B <= 0.0) return;
  // Lorentzians 2s²T/(1+ω²T²), one every ln(kSpacing) in ln T, sum to s²/(2 f ln kSpacing).
  const double variance = B * B * std::log(kSpacing) / std::numbers::pi;
  const double sigma = std::sqrt(variance);
  double rest = 0.0;
  const double slowest = 8.0 * std::max(duration_s, period_s);
  double correlation = period_s / 16.0;
  while (correlation < slowest * kSpacing) {
    const Step s = step_of(period_s / correlation);
    parts_.push_back({s.decay, sigma * s.drive, s.mean_weight, sigma * draw_.normal()});
    rest += variance * s.rest;
    correlation *= kSpacing;
  }
  // Includes processes that are white at this sample time; without them the spectrum would fall below the
  // Nyquist frequency.
  correlation = period_s / 16.0 / kSpacing;
  while (correlation > 1e-9 * period_s) {
    rest += variance * variance_of_mean(period_s / correlation);
    correlation /= kSpacing;
  }
  rest_ = std::sqrt(rest);
}

double Flicker::next() noexcept {
  if (parts_.empty()) return 0.0;
  double sum = rest_ * draw_.normal();
  for (Part& part : parts_) {
    const double before = part.state;
    part.state = part.decay * part.state + part.drive * draw_.normal();
    sum += part.mean_weight * (before + part.state);
  }
  return sum;
}

RateNoise::RateNoise(const NoiseLevels& levels, double sample_rate_hz, double duration_s, std::uint64_t seed,
                     std::uint32_t first_stream)
    : white_(levels.N * std::sqrt(sample_rate_hz)),
      walk_(levels.K / std::sqrt(sample_rate_hz)),
      walk_rest_(walk_ / std::sqrt(12.0)),
      ramp_(levels.R),
      period_(1.0 / sample_rate_hz),
      white_draw_(seed, first_stream),
      walk_draw_(seed, first_stream + 1),
      flicker_(levels.B, period_, duration_s, Draw(seed, first_stream + 2)) {
  check("Q", levels.Q);
  check("N", levels.N);
  check("B", levels.B);
  check("K", levels.K);
  if (!std::isfinite(levels.R)) throw std::invalid_argument("noise R is not finite");
}

double RateNoise::next() noexcept {
  double rate = ramp_ * period_ * (static_cast<double>(step_) + 0.5);
  ++step_;
  if (white_ > 0.0) rate += white_ * white_draw_.normal();
  if (walk_ > 0.0) {
    const double before = walk_state_;
    walk_state_ += walk_ * walk_draw_.normal();
    rate += 0.5 * (before + walk_state_) + walk_rest_ * walk_draw_.normal();
  }
  return rate + flicker_.next();
}

void quantise_angle(std::span<double> rate_radps, double period_s, double lsb_rad) {
  if (!(lsb_rad > 0.0)) return;
  // The angle is whole steps plus a remainder below one step, so that a day of rotation loses no digits.
  double remainder = 0.0;
  for (double& rate : rate_radps) {
    const double steps = rate * period_s / lsb_rad + remainder;
    const double whole = std::nearbyint(steps);
    remainder = steps - whole;
    rate = whole * lsb_rad / period_s;
  }
}

std::vector<double> noise(const NoiseLevels& levels, double sample_rate_hz, std::size_t n, std::uint64_t seed,
                          std::uint32_t first_stream) {
  RateNoise source(levels, sample_rate_hz, static_cast<double>(n) / sample_rate_hz, seed, first_stream);
  std::vector<double> rate(n);
  for (double& value : rate) value = source.next();
  quantise_angle(rate, 1.0 / sample_rate_hz, levels.Q * std::sqrt(12.0));
  return rate;
}

}  // namespace ifog::simulate
