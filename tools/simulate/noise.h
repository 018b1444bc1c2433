// SPDX-License-Identifier: Apache-2.0
// Noise of a gyro from its IEEE Std 952 coefficients, as an integrating gyro outputs it: each sample is the
// mean rate since the previous one. Then the standard's Allan variances hold at every τ, including the sample
// time: Q quantisation 3Q²/τ², N angle random walk N²/τ, B bias instability (2 ln 2/π)B², K rate random walk
// K²τ/3, R rate ramp R²τ²/2. Steps are exact for any size; a sample costs a few draws, and the memory is
// constant.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tools/simulate/draw.h"

namespace ifog::simulate {

struct NoiseLevels {
  double Q = 0.0;  // rad; steps of √12·Q in the integrated angle
  double N = 0.0;  // rad/s/√Hz
  double B = 0.0;  // rad/s; two-sided spectral density of the rate B²/(2πf)
  double K = 0.0;  // rad/s²/√Hz
  double R = 0.0;  // rad/s²
};

// First-order Gauss–Markov process, mean over each step; variance sigma², correlation time correlation_s.
class GaussMarkov {
 public:
  // sigma_radps >= 0, correlation_s > 0, period_s > 0. Starts in its stationary distribution.
  GaussMarkov(double sigma, double correlation_s, double period_s, Draw draw);
  [[nodiscard]] double next() noexcept;

 private:
  double decay_, drive_, mean_weight_, rest_;
  double state_;
  Draw draw_;
};

// 1/f noise as a sum of Gauss–Markov processes with correlation times at a ratio of four: within 0.4 % of
// B²/(2πf) between both limits (Lorentzians spaced by r ripple by 2/cosh(π²/ln r)).
class Flicker {
 public:
  // Valid from the Nyquist frequency down to 1/(8·duration_s); below, the spectrum is flat, which is not
  // visible in a record of duration_s. The start is stationary, so the record's mean is off by a few B, like
  // a switch-on bias.
  Flicker(double B, double period_s, double duration_s, Draw draw);
  [[nodiscard]] double next() noexcept;

 private:
  struct Part {
    double decay, drive, mean_weight, state;
  };
  std::vector<Part> parts_;
  double rest_ = 0.0;  // variance of the mean between given end points, of all parts
  Draw draw_;
};

// White noise, flicker, random walk and ramp; Q is not included because it acts on the final angle.
class RateNoise {
 public:
  // sample_rate_hz > 0; duration_s limits the flicker noise at low frequencies. Uses streams first_stream …
  // first_stream + 2 of the seed. Throws std::invalid_argument with the name of a negative or non-finite
  // level.
  RateNoise(const NoiseLevels& levels, double sample_rate_hz, double duration_s, std::uint64_t seed,
            std::uint32_t first_stream);
  [[nodiscard]] double next() noexcept;  // rad/s

 private:
  double white_, walk_, walk_rest_, ramp_, period_;
  double walk_state_ = 0.0;
  std::uint64_t step_ = 0;
  Draw white_draw_, walk_draw_;
  Flicker flicker_;
};

// Rounds the integrated angle to steps of lsb_rad and differentiates it again, in place, like a gyro that
// counts pulses or sends integer angles. If the angle changes by less than a step per sample, the error is
// not white, as in real gyros. lsb_rad <= 0: no rounding.
void quantise_angle(std::span<double> rate_radps, double period_s, double lsb_rad);

// n samples of all five terms; reproducible.
[[nodiscard]] std::vector<double> noise(const NoiseLevels& levels, double sample_rate_hz, std::size_t n,
                                        std::uint64_t seed, std::uint32_t first_stream = 0);

}  // namespace ifog::simulate
