// SPDX-License-Identifier: Apache-2.0
// From samples to angle increments: unwraps counters and angles, finds gaps, fits the time.
//
// Step time, in this order: the device's clock; the nominal period times the difference of the device's
// counter; the fitted period for a device that has neither. So a replay of the same frames gives the same
// bits, whatever the scheduling did to arrival times, for every device that counts.
//
// The counter says how many samples are missing only modulo its range; where a gap shows, the arrival times
// say how often it went round. Exactly one full round lost within kLongSilence_s cannot be told from a late
// delivery and is taken for one.
#pragma once

#include <array>
#include <cstdint>

#include "filters/chain/fitted_clock.h"
#include "filters/chain/plausibility.h"
#include "filters/chain/reading.h"

namespace ifog {

struct IncrementerCounts {
  std::uint64_t samples = 0;              // increments made
  std::uint64_t gaps = 0;                 // places where samples are missing
  std::uint64_t missing = 0;              // samples missing
  std::uint64_t repeated = 0;             // samples left out because they came twice
  std::uint64_t restarts = 0;             // device counter or clock jumped back: it was switched off and on
  std::uint64_t invalid = 0;              // samples with an axis that may not be used
  std::uint64_t saturated = 0;            // of those: at or beyond full scale
  std::uint64_t implausible = 0;          // of those: marked good, but a value that cannot be
  std::uint64_t channel_implausible = 0;  // values of channels that cannot be; the one before is held
  std::uint64_t clock_steps = 0;          // times the wall clock was set: labels moved, nothing else
};

class Incrementer {
 public:
  // facts.nominal_rate_hz > 0; the caller has checked it.
  explicit Incrementer(const SensorFacts& facts) noexcept;

  // False: the sample came twice (counted), `out` is not touched. No allocation, no exception.
  bool next(const Reading& reading, Increment& out) noexcept;
  // The device was closed and opened: the next sample comes after a gap of unknown length.
  void discontinuity() noexcept { reopened_ = true; }

  [[nodiscard]] const IncrementerCounts& counts() const noexcept { return counts_; }
  // Fitted against nominal period, 1e-6; 0 until the line has settled.
  [[nodiscard]] double clock_offset_ppm() const noexcept;

 private:
  struct Step {
    std::uint64_t samples = 1;  // of the device, since the reading before
    double dt_s = 0.0;
    bool gap = false;
    bool restarted = false;
    bool repeated = false;
  };
  [[nodiscard]] Step step(const Reading& reading) const noexcept;
  [[nodiscard]] Step step_by_counter(const Reading& reading, double elapsed_s) const noexcept;
  [[nodiscard]] Step step_by_clock(const Reading& reading, double elapsed_s) const noexcept;
  [[nodiscard]] Step step_by_arrival(const Reading& reading, double elapsed_s) const noexcept;
  void measure(const Reading& reading, const Step& step, Increment& out) noexcept;
  void hold_channels(const Reading& reading, std::uint64_t samples, Increment& out) noexcept;
  [[nodiscard]] Verdict turn(std::size_t axis, double value, double own_s, Turn& out) noexcept;

  SensorFacts facts_;
  double period_s_;
  FittedClock clock_;
  bool started_ = false;
  bool reopened_ = false;
  Reading last_;
  std::int64_t known_arrival_ns_ = 0;  // latest arrival time that is known; 0: none yet
  double counted_s_ = 0.0;             // steps since then
  std::uint64_t sequence_ = 0;
  std::array<PlausibleRate, kMaxAxes> rate_;
  std::array<PlausibleAngle, kMaxAxes> angle_;  // SensorKind::angle
  std::array<PlausibleValue, kMaxChannels> frame_channel_;
  std::array<double, kMaxChannels> channel_{};
  std::array<float, kMaxChannels> channel_age_s_{};
  IncrementerCounts counts_;
};

}  // namespace ifog
