#include "filters/estimator/fading_trackers.h"

#include <algorithm>
#include <cmath>

#include "filters/random/log_exp.h"

namespace ifog {
namespace {

// Of the log-likelihood of a past sample, what still counts at the next: twenty samples of memory.
constexpr double kForget = 0.95;
// A normalised square this much above that of the best predictor says no more: one bad sample must not rule a
// tracker out for long. Above the best one's: in a blow that surprises all of them, the least surprised
// counts.
constexpr double kMostSquare = 25.0;
// Least log-weight below the likeliest: how quickly a tracker that was wrong for long can come back.
constexpr double kLeastLogWeight = -8.0;
// Innovations all beyond this many of their own sigmas, or of what they have lately been, are held back for
// one sample.
constexpr double kImprobable = 5.5;
// After more missed samples than this a polynomial's prediction is worth nothing.
constexpr double kMostSteps = 16.0;

}  // namespace

FadingTrackers::FadingTrackers() {
  for (std::size_t j = 0; j < kTrackers; ++j) {
    const double m = 1.0 - kTheta[j];
    Gains& g = settled_[j];
    g.rate = 1.0 - kTheta[j] * kTheta[j] * kTheta[j];
    g.slope = 1.5 * m * m * (1.0 + kTheta[j]);
    g.curvature = 0.5 * m * m * m;
    // Variances from the response to one unit measurement.
    double x = 0.0, s = 0.0, c = 0.0;
    double innovations = 0.0, outputs = 0.0;
    for (int k = 0; k < 4000; ++k) {
      x += s + c;
      s += 2.0 * c;
      const double innovation = (k == 0 ? 1.0 : 0.0) - x;
      x += g.rate * innovation;
      s += g.slope * innovation;
      c += g.curvature * innovation;
      innovations += innovation * innovation;
      outputs += x * x;
    }
    g.innovation_factor = innovations;
    g.output_factor = outputs;
  }
}

// Gains of the growing-memory filter (a least-squares parabola through all measurements so far) until the
// fading ones are larger. The first two steps are a point and a line.
FadingTrackers::Gains FadingTrackers::growing(std::size_t tracker) const noexcept {
  if (age_ == 0) return {1.0, 0.0, 0.0, 1e6, 1.0};
  if (age_ == 1) return {1.0, 1.0, 0.0, 1e6, 1.0};
  const double n = age_;
  const double product = (n + 1) * (n + 2) * (n + 3);
  const double rate = 3.0 * (3.0 * n * n + 3.0 * n + 2.0) / product;
  if (rate <= settled_[tracker].rate) return settled_[tracker];
  const double factor = rate < 1.0 ? 1.0 / (1.0 - rate) : 1e6;
  return {rate, 18.0 * (2.0 * n + 1.0) / product, 30.0 / product, factor, rate};
}

double FadingTrackers::factor(std::size_t tracker) const noexcept {
  return growing(tracker).innovation_factor;
}

std::size_t FadingTrackers::best() const noexcept {
  return static_cast<std::size_t>(std::max_element(weight_.begin(), weight_.begin() + kTrackers) -
                                  weight_.begin());
}

void FadingTrackers::begin(std::span<const Axes> last) noexcept {
  age_ = 0;
  rate_ = slope_ = curvature_ = innovation_ = {};
  surprise_ = {};
  log_weight_ = {};
  weight_.fill(1.0 / static_cast<double>(kTrackers + 1));
  for (const Axes& rate : last) {
    if (age_ > 0) predict(1.0);
    correct(rate, ~0U);
  }
}

void FadingTrackers::predict(double steps) noexcept {
  if (steps > kMostSteps) age_ = 0;
  steps_ = steps;
  for (std::size_t j = 0; j < kTrackers; ++j) {
    for (std::size_t axis = 0; axis < kMaxAxes; ++axis) {
      if (age_ == 0) slope_[j][axis] = curvature_[j][axis] = 0.0;
      rate_[j][axis] += steps * (slope_[j][axis] + steps * curvature_[j][axis]);
      slope_[j][axis] += 2.0 * steps * curvature_[j][axis];
    }
  }
}

bool FadingTrackers::improbable(const Axes& rate, const Axes& noise, std::uint32_t valid_axes) noexcept {
  bool any = false;
  for (std::size_t axis = 0; axis < kMaxAxes; ++axis) {
    last_surprise_[axis] = 0.0;
    if ((valid_axes >> axis & 1U) == 0 || !(noise[axis] > 0.0)) continue;
    double least = 1e300;
    for (std::size_t j = 0; j < kTrackers; ++j) {
      const double innovation = rate[axis] - rate_[j][axis];
      least = std::min(least, innovation * innovation / (factor(j) * noise[axis]));
    }
    last_surprise_[axis] = least;
    any = any || least > kImprobable * kImprobable * std::max(1.0, surprise_[axis]);
  }
  return any;
}

void FadingTrackers::begin_again(std::span<const Axes> last) noexcept {
  Axes surprise{};
  for (std::size_t axis = 0; axis < kMaxAxes; ++axis)
    surprise[axis] = std::max(surprise_[axis], last_surprise_[axis]);
  begin(last);
  surprise_ = surprise;
}

void FadingTrackers::correct(const Axes& rate, std::uint32_t valid_axes) noexcept {
  for (std::size_t j = 0; j < kTrackers; ++j) {
    const Gains g = growing(j);
    for (std::size_t axis = 0; axis < kMaxAxes; ++axis) {
      const double innovation = (valid_axes >> axis & 1U) != 0 ? rate[axis] - rate_[j][axis] : 0.0;
      innovation_[j][axis] = innovation;
      rate_[j][axis] += g.rate * innovation;
      slope_[j][axis] += g.slope / steps_ * innovation;
      curvature_[j][axis] += g.curvature / (steps_ * steps_) * innovation;
    }
  }
  ++age_;
}

void FadingTrackers::update(const Axes& rate, const Axes& noise, std::uint32_t valid_axes,
                            const Axes& level_innovation, double level_factor) noexcept {
  std::array<double, kTrackers + 1> factors{}, log_factors{};
  for (std::size_t j = 0; j < kTrackers; ++j) factors[j] = factor(j);
  factors[kTrackers] = level_factor;
  for (std::size_t j = 0; j <= kTrackers; ++j) log_factors[j] = logarithm(factors[j]);
  correct(rate, valid_axes);
  for (std::size_t j = 0; j <= kTrackers; ++j) log_weight_[j] *= kForget;
  std::array<double, kTrackers + 1> squares{};
  for (std::size_t axis = 0; axis < kMaxAxes; ++axis) {
    if ((valid_axes >> axis & 1U) == 0 || !(noise[axis] > 0.0)) continue;
    double least = 1e300;
    for (std::size_t j = 0; j <= kTrackers; ++j) {
      const double innovation = j < kTrackers ? innovation_[j][axis] : level_innovation[axis];
      squares[j] = innovation * innovation / (factors[j] * noise[axis]);
      least = std::min(least, squares[j]);
    }
    surprise_[axis] += (1.0 - kForget) * (last_surprise_[axis] - surprise_[axis]);
    for (std::size_t j = 0; j <= kTrackers; ++j)
      log_weight_[j] -= 0.5 * (std::min(squares[j] - least, kMostSquare) + log_factors[j]);
  }
  const double greatest = *std::max_element(log_weight_.begin(), log_weight_.end());
  double sum = 0.0;
  for (std::size_t j = 0; j <= kTrackers; ++j) {
    log_weight_[j] = std::max(log_weight_[j] - greatest, kLeastLogWeight);
    sum += weight_[j] = exponential(log_weight_[j]);
  }
  for (double& weight : weight_) weight /= sum;
}

double FadingTrackers::rate(std::size_t axis, double level) const noexcept {
  double mean = weight_[kTrackers] * level;
  for (std::size_t j = 0; j < kTrackers; ++j) mean += weight_[j] * rate_[j][axis];
  return mean;
}

double FadingTrackers::variance(std::size_t axis, double level, double level_variance,
                                double noise) const noexcept {
  const double mean = rate(axis, level);
  double sum = weight_[kTrackers] * (level_variance + (level - mean) * (level - mean));
  for (std::size_t j = 0; j < kTrackers; ++j) {
    const double apart = rate_[j][axis] - mean;
    sum += weight_[j] * (growing(j).output_factor * noise + apart * apart);
  }
  return sum;
}

double FadingTrackers::gain(double level_gain) const noexcept {
  double mean = weight_[kTrackers] * level_gain;
  for (std::size_t j = 0; j < kTrackers; ++j) mean += weight_[j] * growing(j).rate;
  return mean;
}

}  // namespace ifog
