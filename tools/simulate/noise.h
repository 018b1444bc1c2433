// SPDX-License-Identifier: Apache-2.0
// The noise of a gyro by its IEEE Std 952 coefficients, as a real integrating gyro delivers it: each sample
// is the mean rate since the sample before. With that the Allan variances of the standard hold at every τ,
// the sample time included:
//   Q quantisation 3Q²/τ², N angle random walk N²/τ, B bias instability (2 ln 2/π)B², K rate random walk
//   K²τ/3, R rate ramp R²τ²/2.
// Every step is exact, not a small-step approximation; the cost is a few draws a sample, the memory constant.
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

// First-order Gauss–Markov process, mean over each step: variance sigma² and correlation time at any instant.
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

// 1/f noise as a sum of Gauss–Markov processes whose correlation times are a factor of four apart: within 0.4
// % of B²/(2πf) between the two ends (Lorentzians spaced by r ripple by 2/cosh(π²/ln r)).
class Flicker {
 public:
  // Holds from the Nyquist frequency down to 1/(8·duration_s); below that the spectrum is flat, which a
  // record of duration_s cannot see. The start is stationary, so the record's mean is off by a few B, as a
  // switch-on bias is.
  Flicker(double B, double period_s, double duration_s, Draw draw);
  [[nodiscard]] double next() noexcept;

 private:
  struct Part {
    double decay, drive, mean_weight, state;
  };
  std::vector<Part> parts_;
  double rest_ = 0.0;  // what the means vary by between given end points, all parts together
  Draw draw_;
};

// White, flicker, random walk and ramp together; Q is not here, because it acts on the angle last of all.
class RateNoise {
 public:
  // sample_rate_hz > 0; duration_s sets the slow end of the flicker noise. Streams first_stream …
  // first_stream + 2 of the seed are used. Throws std::invalid_argument naming a negative or non-finite
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

// Rounds the integrated angle to steps of lsb_rad and differences it again, in place: what a gyro that counts
// pulses or sends a whole-number angle delivers. Where the angle moves by less than a step a sample, the
// error is far from white; that is so in the real ones too. lsb_rad <= 0 leaves the rate alone.
void quantise_angle(std::span<double> rate_radps, double period_s, double lsb_rad);

// n samples of all five terms. Same arguments, same bits.
[[nodiscard]] std::vector<double> noise(const NoiseLevels& levels, double sample_rate_hz, std::size_t n,
                                        std::uint64_t seed, std::uint32_t first_stream = 0);

}  // namespace ifog::simulate
