// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/quality/motions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace ifog::bench {
namespace {

constexpr double kPi = std::numbers::pi;

// 0 for t < 0, 1 for t > 1.
double raised_cosine(double t) { return 0.5 - 0.5 * std::cos(kPi * std::clamp(t, 0.0, 1.0)); }

std::size_t in_samples(double seconds) {
  return static_cast<std::size_t>(std::lround(seconds * kSampleRate_hz));
}

double random_phase(Random& random) { return std::uniform_real_distribution<double>(0.0, 2.0 * kPi)(random); }

// One conjugate pair of poles of a low-pass, direct form II transposed.
struct Section {
  double b0, a1, a2;
  double s1 = 0.0, s2 = 0.0;
  double operator()(double x) {
    const double y = b0 * x + s1;
    s1 = 2.0 * b0 * x - a1 * y + s2;
    s2 = b0 * x - a2 * y;
    return y;
  }
};

constexpr int kOrder = 8;

// By the bilinear transform with a prewarped corner; `corner` = tan(π f_c / f_s).
std::array<Section, kOrder / 2> butterworth(double corner) {
  std::array<Section, kOrder / 2> sections{};
  for (int k = 0; k < kOrder / 2; ++k) {
    const double damping = 2.0 * std::sin(kPi * (2 * k + 1) / (2.0 * kOrder));
    const double scale = 1.0 / (1.0 + damping * corner + corner * corner);
    sections[static_cast<std::size_t>(k)] = {.b0 = corner * corner * scale,
                                             .a1 = 2.0 * (corner * corner - 1.0) * scale,
                                             .a2 = (1.0 - damping * corner + corner * corner) * scale};
  }
  return sections;
}

// Variance of the filter's output for white noise of variance one: mean of |H|² over frequency. The trapezoid
// rule is exact to rounding for a smooth periodic function.
double power_passed(double corner) {
  constexpr int kPoints = 1 << 16;
  double sum = 0.5;  // |H|² at frequency zero; it is zero at half the sample rate
  for (int i = 1; i < kPoints; ++i)
    sum += 1.0 / (1.0 + std::pow(std::tan(0.5 * kPi * i / kPoints) / corner, 2 * kOrder));
  return sum / kPoints;
}

// Gaussian of that standard deviation with a flat spectrum up to `band_hz`.
std::vector<double> unfaded(Random& random, std::size_t samples, double rms, double band_hz) {
  constexpr double kRunInBands = 30.0;
  const double corner = std::tan(kPi * band_hz / kSampleRate_hz);
  const double scale = rms / std::sqrt(power_passed(corner));
  auto sections = butterworth(corner);
  std::normal_distribution<double> normal;
  const auto next = [&] {
    double x = normal(random);
    for (Section& section : sections) x = section(x);
    return x;
  };
  for (std::size_t i = in_samples(kRunInBands / band_hz); i > 0; --i) next();
  std::vector<double> rate(samples, 0.0);
  for (double& value : rate) value = scale * next();
  return rate;
}

}  // namespace

std::vector<double> ramp(std::size_t samples, std::size_t from, std::size_t until, double slope) {
  std::vector<double> rate(samples, 0.0);
  for (std::size_t i = from; i < samples; ++i)
    rate[i] = slope * static_cast<double>(std::min(i, until) - from);
  return rate;
}

std::vector<double> steps(Random& random, std::size_t samples, std::size_t from, double size) {
  std::uniform_int_distribution<std::size_t> interval(in_samples(7.5), in_samples(12.5));
  const std::array<double, 4> levels{size, 0.0, -size, 0.0};
  std::vector<double> rate(samples, 0.0);
  for (std::size_t i = from, number = 0; i < samples; ++number) {
    const std::size_t until = std::min(samples, i + interval(random));
    for (; i < until; ++i) rate[i] = levels[number % levels.size()];
  }
  return rate;
}

std::vector<double> turns(std::size_t samples, std::size_t from, double size) {
  const std::size_t half = in_samples(10.0);
  const auto edge = static_cast<double>(in_samples(0.25));
  std::vector<double> rate(samples, 0.0);
  for (std::size_t i = from; i < samples; ++i) {
    const std::size_t number = (i - from) / half;
    const double into = raised_cosine(static_cast<double>((i - from) % half) / edge);
    const double sign = number / 2 % 2 == 0 ? 1.0 : -1.0;
    rate[i] = sign * size * (number % 2 == 0 ? into : 1.0 - into);
  }
  return rate;
}

std::vector<double> sway(Random& random, std::size_t samples, std::size_t from, double amplitude,
                         double frequency_hz) {
  const double phase = random_phase(random), cycles = frequency_hz / kSampleRate_hz;
  std::vector<double> rate(samples, 0.0);
  for (std::size_t i = from; i < samples; ++i) {
    const double t = cycles * static_cast<double>(i - from);
    rate[i] = amplitude * raised_cosine(t) * std::sin(2.0 * kPi * t + phase);
  }
  return rate;
}

std::vector<double> sway_that_ends(Random& random, std::size_t samples, std::size_t until, double amplitude,
                                   double frequency_hz) {
  const double phase = random_phase(random), cycles = frequency_hz / kSampleRate_hz;
  std::vector<double> rate(samples, 0.0);
  for (std::size_t i = 0; i < until; ++i) {
    const double left = cycles * static_cast<double>(until - i);
    rate[i] = amplitude * raised_cosine(2.0 * left) * std::sin(phase - 2.0 * kPi * left);
  }
  return rate;
}

std::vector<double> random_motion(Random& random, std::size_t samples, std::size_t from, double rms,
                                  double band_hz) {
  constexpr double kFade_s = 10.0;
  std::vector<double> rate = unfaded(random, samples - from, rms, band_hz);
  rate.insert(rate.begin(), from, 0.0);
  for (std::size_t i = from; i < samples; ++i)
    rate[i] *= raised_cosine(static_cast<double>(i - from) / (kFade_s * kSampleRate_hz));
  return rate;
}

std::vector<double> shaking(Random& random, std::size_t samples, double rms, double band_hz) {
  constexpr double kCorner = 0.02;  // of the sample rate
  std::vector<double> rate = unfaded(random, samples, rms, band_hz);
  double slow = 0.0;
  for (double& value : rate) {
    slow += 2.0 * kPi * kCorner * (value - slow);
    value -= slow;
  }
  return rate;
}

}  // namespace ifog::bench
