// SPDX-License-Identifier: Apache-2.0
// The motions of the regimes against what they are said to be: slopes, sizes, areas, amplitudes by
// projection, and the spectrum of random motion against the closed form of the Butterworth filter.
#include "tests/bench/quality/motions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace {

using ifog::bench::kSampleRate_hz;
using ifog::bench::Random;

constexpr double kPi = std::numbers::pi;

// Complex amplitude of a sine of that frequency over [from, until), whole periods: its modulus is the peak.
double amplitude(const std::vector<double>& rate, std::size_t from, std::size_t until, double frequency_hz) {
  std::complex<double> sum;
  for (std::size_t i = from; i < until; ++i)
    sum += rate[i] * std::polar(1.0, -2.0 * kPi * frequency_hz / kSampleRate_hz * static_cast<double>(i));
  return 2.0 * std::abs(sum) / static_cast<double>(until - from);
}

double largest(const std::vector<double>& rate, std::size_t from, std::size_t until) {
  double most = 0.0;
  for (std::size_t i = from; i < until; ++i) most = std::max(most, std::abs(rate[i]));
  return most;
}

TEST(Motions, SwayHasItsAmplitudeAfterOnePeriod) {
  for (const double frequency_hz : {0.1, 0.02}) {
    Random random(2);
    const auto period = static_cast<std::size_t>(std::lround(kSampleRate_hz / frequency_hz));
    const auto rate = ifog::bench::sway(random, 5 * period + 300, 300, 30.0, frequency_hz);
    EXPECT_EQ(largest(rate, 0, 300), 0.0);
    EXPECT_LT(largest(rate, 300, 300 + period / 20), 30.0 * 0.01);
    EXPECT_NEAR(amplitude(rate, 300 + period, 300 + 5 * period, frequency_hz), 30.0, 1e-9);
    // All of its power is in that line.
    double squares = 0.0;
    for (std::size_t i = 300 + period; i < rate.size(); ++i) squares += rate[i] * rate[i];
    EXPECT_NEAR(squares / static_cast<double>(4 * period), 450.0, 1e-8);
  }
}

// One-sided density at `frequency_hz` by the mean of periodograms with Hann's window, of overlapping
// segments.
double density(const std::vector<double>& rate, std::size_t from, std::size_t segment, double frequency_hz) {
  double sum = 0.0, count = 0.0;
  for (std::size_t start = from; start + segment <= rate.size(); start += segment / 2, count += 1.0) {
    std::complex<double> line;
    double window_power = 0.0;
    for (std::size_t i = 0; i < segment; ++i) {
      const auto at = static_cast<double>(i);
      const double w = 0.5 - 0.5 * std::cos(2.0 * kPi * at / static_cast<double>(segment));
      window_power += w * w;
      line += w * rate[start + i] * std::polar(1.0, -2.0 * kPi * frequency_hz / kSampleRate_hz * at);
    }
    sum += 2.0 * std::norm(line) / window_power / kSampleRate_hz;
  }
  return sum / count;
}

// |H|² of the eighth order; far below half the sample rate its area is the corner times (π/16)/sin(π/16).
double butterworth(double frequency_hz, double band_hz) {
  const double x = std::tan(kPi * frequency_hz / kSampleRate_hz) / std::tan(kPi * band_hz / kSampleRate_hz);
  return 1.0 / (1.0 + std::pow(x, 16));
}

TEST(Motions, RandomMotionHasItsSpectrum) {
  for (const double band_hz : {1.0, 10.0}) {
    Random random(5);
    constexpr double kRms = 3.0;
    const auto samples = static_cast<std::size_t>(800'000.0 / band_hz);
    const std::size_t from = 4000;  // faded in from 2000 on
    const auto rate = ifog::bench::random_motion(random, samples, 2000, kRms, band_hz);
    EXPECT_EQ(largest(rate, 0, 2001), 0.0);
    EXPECT_LT(largest(rate, 2000, 2100), 0.2 * kRms);

    double squares = 0.0;
    for (std::size_t i = from; i < samples; ++i) squares += rate[i] * rate[i];
    const double seconds = static_cast<double>(samples - from) / kSampleRate_hz;
    // A flat band gives 2·band·time independent values, each square with a variance of twice its mean's
    // square.
    EXPECT_NEAR(squares / static_cast<double>(samples - from) / (kRms * kRms), 1.0,
                5.0 * std::sqrt(1.0 / (band_hz * seconds)));

    const auto segment = static_cast<std::size_t>(4096.0 / band_hz);
    const double averages = seconds * kSampleRate_hz / static_cast<double>(segment);
    const double flat = kRms * kRms / (band_hz * (kPi / 16.0) / std::sin(kPi / 16.0));
    for (const double part : {0.1, 0.3, 0.6, 0.85, 1.0, 1.1, 1.25}) {
      const double expected = flat * butterworth(part * band_hz, band_hz);
      // Beyond chance, a hundredth for the curvature of |H|² within the window's resolution, twice that at
      // the steep end.
      EXPECT_NEAR(density(rate, from, segment, part * band_hz) / expected, 1.0,
                  5.0 / std::sqrt(averages) + (part > 0.8 ? 0.1 : 0.01))
          << part << " of " << band_hz << " Hz";
    }
    EXPECT_LT(density(rate, from, segment, 2.5 * band_hz), 1e-4 * flat);
  }
}

}  // namespace
