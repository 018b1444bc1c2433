// SPDX-License-Identifier: Apache-2.0
// A feedback ramp that nobody logs, rebuilt from the measured rate. A closed loop resets its ramp every 2 pi,
// so the ramp's phase is k times the angle turned, and the ramp's nonlinearity is an error of the angle,
// f(phase): of the rate f(phase now) - f(phase before) over the time between. f and k come from a model; the
// phase at the start, after a gap or after a long turn nobody knows, and is acquired from the rate itself.
//
// Acquiring: 256 phases side by side, each with the share of the rate's energy that the table explains from
// there. One is accepted if its likelihood is e^25 times that of no ramp at all, the size of the noise being
// free: without a ramp that happens, by Ville's inequality, once in 10^8 tries. Until then nothing is
// corrected.
// Following: the same for 64 phases close together around the likeliest, whose likelihoods are tempered by
// what the phase may have moved since: by its own walk, by k when the gyro turns, by a gap. A Kalman filter
// would not do: a ramp's flyback is a step, and where it stands in a sample makes a likelihood with edges.
// What is subtracted is the table's mean over the phases still possible, so that a vague phase puts in no
// noise. A slower frequency offset (an uncertain bias, k over temperature) is followed as well. A phase too
// vague for the table to be of use is acquired again, as is a phase that no longer explains the rate.
//
// A sample is compared with what the ramp makes of it at the mean rate, not at the sample's own: near a
// standstill f(phase now) - f(phase before) is in proportion to the rotation itself, and a phase could be
// found that explains rotation away.
//
// The correction is bounded as an angle, by one swing of the table, for as long as the phase is known; each
// time it is lost what stands then stays: it cannot swallow rotation.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "filters/model_file/model.h"

namespace ifog {

struct RampSettings {
  double cycles_per_rad = 0.0;
  // One cycle at even steps, the first value not repeated, rad. Between them the band-limited function
  // through them.
  std::vector<double> angle_rad;
  double noise_density = 0.0;  // of the rate without the ramp, rad/s/sqrt(Hz)
  double phase_walk = 0.0;     // of the true phase against k times the angle, cycles/sqrt(s)
};

// Settings of an effect "rebuilt_ramp". Throws std::invalid_argument with what is wrong with it.
RampSettings ramp_settings(const Effect& effect);

struct RampSample {
  double measured_radps = 0.0;  // NaN: not measured
  double rest_radps = 0.0;      // less all other effects
  double dt_s = 0.0;            // since the sample before
  double missed_s = 0.0;        // of dt: time in which the angle turned is not known
};

// What a tracker knows, apart from its settings.
struct RampState {
  static constexpr std::size_t kCells = 256;  // phases tried while acquiring
  static constexpr std::size_t kNear = 64;    // while following

  double phase_ = 0.0;  // k times the angle turned, and the frequency offset's part, cycles in [0, 1)
  double slow_ = 0.0, slow_weight_ = 0.0;
  double scatter_ = 0.0, scatter_weight_ = 0.0;
  double turning_ = 0.0;  // the same of k times the rate as measured, cycles/s
  int beside_ = 0;        // samples running that are far from the slow part
  int undecided_ = 0;     // samples since the phases were last compared
  bool locked_ = false;

  std::array<float, kCells> gained_{};  // weighted energy that each phase explains
  double energy_ = 0.0, samples_ = 0.0, turned_ = 0.0;

  std::array<float, kNear> near_{};  // the same around the phase that is followed
  std::size_t first_near_ = 0;       // table step of the first of them
  double offset_ = 0.0;              // their mean: what to add to phase_, cycles
  double variance_ = 0.0;            // cycles^2
  double frequency_ = 0.0;           // Hz
  double settled_ = 0.0;             // cycles/s, at which the phase has been followed of late
  std::size_t table_ = 0;            // in use
  double angle_ = 0.0;               // removed so far, rad
  double proof_ = 0.0;               // energy that the correction explains, recent
};

class RampTracker : private RampState {
 public:
  // Throws std::invalid_argument for settings that no ramp has.
  explicit RampTracker(RampSettings settings);

  // What the ramp puts into the rate of this sample, rad/s; 0 while the phase is not known. No allocation, no
  // exception.
  double step(const RampSample& in) noexcept;
  [[nodiscard]] bool locked() const noexcept { return locked_; }
  // The same ramp of another tracker continues where that one is. False when it is not the same.
  bool take_over(const RampTracker& previous) noexcept;

 private:
  static constexpr std::size_t kSteps = 4096;  // of a table
  static constexpr std::size_t kVague = 10;    // tables
  static constexpr double kVaguest = 0.128;    // standard deviation of the first one's phases, cycles

  // A table of which every so many steps lie side by side, twice over: neighbours are phases tried.
  struct Comb {
    std::size_t stride = 0;
    std::vector<float> angle;
    void set(const std::vector<double>& table, std::size_t steps_apart);
    [[nodiscard]] const float* at(std::size_t step) const noexcept {
      return angle.data() + step % stride * (2 * kSteps / stride) + step / stride;
    }
  };
  // Rate, less its slow part, and how much it may count.
  struct Sight {
    double start, end;  // cycles, of the angle turned alone
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
  std::vector<double> tables_;  // kVague of kSteps + 1, each over phases half as vague as the one before
  Comb wide_, near_by_;         // for acquiring and for following
  // Variances of the phase, cycles^2: above the first it is of no use; below the second it counts as exact.
  double most_variance_ = 0.0, least_variance_ = 0.0;
};

}  // namespace ifog
