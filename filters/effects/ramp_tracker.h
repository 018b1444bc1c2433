// SPDX-License-Identifier: Apache-2.0
// Feedback ramp that is not logged, rebuilt from the measured rate. A closed loop resets its ramp every 2 pi,
// so the ramp's phase is k times the turned angle. Its nonlinearity is an angle error f(phase), and the rate
// error is f(phase now) - f(phase before) over the time between. f and k are from a model. The phase is
// unknown at the start, after a gap and after a long turn, and is acquired from the rate.
//
// Acquisition: 256 phases in parallel, each with the energy of the rate that the table explains from there. A
// phase is accepted if its likelihood is e^25 times that without a ramp, with free noise level. By chance
// that happens once in 10^8 tries (Ville's inequality). Until then nothing is corrected.
//
// Tracking: the same with 64 phases around the most likely one. Their likelihoods are tempered by the
// possible change of the phase: its random walk, the error of k in turns, gaps. A Kalman filter is not
// suitable, since the flyback is a step and the likelihood has edges. The mean of the table over the possible
// phases is subtracted, so an uncertain phase adds no noise. A slow frequency offset (bias error, k over
// temperature) is tracked too. If the phase becomes too uncertain or no longer explains the rate, it is
// acquired again.
//
// The expected ramp error uses the mean rate, not the sample's: near standstill f(phase now) - f(phase
// before) is proportional to the rotation, and a phase could be found that explains rotation.
//
// The angle of the correction is bounded by the range of the table while the phase is known; each loss leaves
// what was corrected. So it cannot remove rotation.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "filters/model_file/model.h"

namespace ifog {

struct RampSettings {
  double cycles_per_rad = 0.0;
  // One cycle at even steps, without repeating the first value, rad; band-limited interpolation between them.
  std::vector<double> angle_rad;
  double noise_density = 0.0;  // of the rate without the ramp, rad/s/sqrt(Hz)
  double phase_walk = 0.0;     // random walk of the true phase relative to k times the angle, cycles/sqrt(s)
};

// Settings of an effect "rebuilt_ramp". Throws std::invalid_argument that names the error.
RampSettings ramp_settings(const Effect& effect);

struct RampSample {
  double measured_radps = 0.0;  // NaN: not measured
  double rest_radps = 0.0;      // minus all other effects
  double dt_s = 0.0;            // since the previous sample
  double missed_s = 0.0;        // part of dt with unknown rotation
};

// State of a tracker, without its settings.
struct RampState {
  static constexpr std::size_t kCells = 256;  // phases tried while acquiring
  static constexpr std::size_t kNear = 64;    // while tracking

  double phase_ = 0.0;  // k times the turned angle plus the frequency offset's part, cycles in [0, 1)
  double slow_ = 0.0, slow_weight_ = 0.0;
  double scatter_ = 0.0, scatter_weight_ = 0.0;
  double turning_ = 0.0;  // slow part of k times the measured rate, cycles/s
  int far_off_ = 0;       // consecutive samples far from the slow part
  int undecided_ = 0;     // samples since the phases were last compared
  bool locked_ = false;

  std::array<float, kCells> gained_{};  // weighted energy that each phase explains
  double energy_ = 0.0, samples_ = 0.0, turned_ = 0.0;

  std::array<float, kNear> near_{};  // the same around the tracked phase
  std::size_t first_near_ = 0;       // table step of the first one
  double offset_ = 0.0;              // their mean relative to phase_, cycles
  double variance_ = 0.0;            // cycles^2
  double frequency_ = 0.0;           // Hz
  double settled_ = 0.0;             // rate of the recent tracking, cycles/s
  std::size_t table_ = 0;            // index in use
  double angle_ = 0.0;               // angle corrected so far, rad
  double proof_ = 0.0;               // energy recently explained by the correction
};

class RampTracker : private RampState {
 public:
  // Throws std::invalid_argument for invalid settings.
  explicit RampTracker(RampSettings settings);

  // Rate error of this sample due to the ramp, rad/s; 0 while the phase is unknown. No allocation, no
  // exception.
  double step(const RampSample& in) noexcept;
  [[nodiscard]] bool locked() const noexcept { return locked_; }
  // Continues the state of another tracker; false if its ramp differs.
  bool take_over(const RampTracker& previous) noexcept;

 private:
  static constexpr std::size_t kSteps = 4096;  // per table
  static constexpr std::size_t kVague = 10;    // tables
  static constexpr double kVaguest = 0.128;    // standard deviation of the phase for the first table, cycles

  // Table with entries `stride` apart stored contiguously, twice, so that neighbouring phases are adjacent.
  struct Comb {
    std::size_t stride = 0;
    std::vector<float> angle;
    void set(const std::vector<double>& table, std::size_t steps_apart);
    [[nodiscard]] const float* at(std::size_t step) const noexcept {
      return angle.data() + step % stride * (2 * kSteps / stride) + step / stride;
    }
  };
  // Rate minus its slow part, and its weight.
  struct Sight {
    double start, end;  // cycles, from the turned angle alone
    double expected;    // end at the mean rate
    double covered_s;
    double error, weight;
  };

  void build_tables();
  void use_table() noexcept;
  [[nodiscard]] double at(double cycles) const noexcept;
  void pass_over(double missed_s) noexcept;
  void loosen_by_turning(double cycles, double covered_s) noexcept;
  void loosen(double variance) noexcept;
  void acquire(const Sight& sight) noexcept;
  void decide() noexcept;
  void lock(std::size_t cell) noexcept;
  double follow(const Sight& sight) noexcept;
  void locate(double seconds) noexcept;
  void recentre(std::size_t middle) noexcept;
  void lose() noexcept;
  void learn_slow_part(double rest, double without_ramp, double turning, double variance) noexcept;

  RampSettings settings_;
  // KVague tables of kSteps + 1; each averages over half the phase uncertainty of the one before
  std::vector<double> tables_;
  Comb wide_, near_by_;  // for acquisition and tracking
  // Variances of the phase, cycles^2: above the first it is useless, below the second it counts as exact.
  double most_variance_ = 0.0, least_variance_ = 0.0;
};

}  // namespace ifog
