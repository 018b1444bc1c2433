// SPDX-License-Identifier: Apache-2.0
// From samples to angle increments: unwraps counters and angles, finds gaps, fits the time.
//
// Step time, in this order: the device's clock; the nominal period times the difference of the device's
// counter; the fitted period for a device that has neither. So a replay of the same frames gives the same
// bits, whatever the scheduling did to arrival times, for every device that counts.
//
// What is new, a duplicate or overtaken, and how many samples are missing: drivers/timeline/timeline.h.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "drivers/timeline/timeline.h"
#include "filters/chain/fitted_clock.h"
#include "filters/chain/plausibility.h"
#include "filters/chain/reading.h"
#include "filters/chain/sensor_check.h"

namespace ifog {

struct IncrementerCounts {
  std::uint64_t samples = 0;   // increments made
  std::uint64_t gaps = 0;      // places where samples are missing
  std::uint64_t missing = 0;   // samples missing
  std::uint64_t untold = 0;    // of those: or the device's clock was set, and nothing tells which
  std::uint64_t repeated = 0;  // samples dropped as duplicates or because a later one had arrived
  std::uint64_t mixed = 0;     // of those: two devices send on one line, and both are dropped
  std::uint64_t restarts = 0;  // device counter or clock jumped back: it was switched off and on
  // Samples with an axis that may not be used. An axis that the device has never marked good may not exist:
  // its missing values count from its first good one.
  std::uint64_t invalid = 0;
  std::uint64_t saturated = 0;            // of those: at or beyond full scale
  std::uint64_t implausible = 0;          // of those: marked good, but a value that cannot be
  std::uint64_t channel_implausible = 0;  // values of channels that cannot be; the one before is held
  std::uint64_t clock_steps = 0;          // times the clock of the labels was set: they moved, nothing else
  std::uint64_t sensor_clock_sets = 0;    // times the device's own clock was set while it measured on
  std::uint64_t pauses = 0;  // times they moved because the device had not counted on for a while
};

class Incrementer {
 public:
  // facts.nominal_rate_hz > 0; the caller has checked it.
  explicit Incrementer(const SensorFacts& facts) noexcept;

  // False: the sample is a duplicate (counted), `out` is not touched. No allocation, no exception.
  bool next(const Reading& reading, Increment& out) noexcept;
  // The device was closed and opened: the next sample comes after a gap of unknown length.
  void discontinuity() noexcept { reopened_ = true; }

  [[nodiscard]] const IncrementerCounts& counts() const noexcept { return counts_; }
  // Bits of the axes that the device has marked good at least once.
  [[nodiscard]] std::uint32_t axes_seen() const noexcept { return seen_.axes; }
  // Two devices send on one line, and no frame is accepted.
  [[nodiscard]] bool mixed() const noexcept { return timeline_.two_devices(); }
  // Fitted against nominal period, 1e-6; 0 until the line has settled.
  [[nodiscard]] double clock_offset_ppm() const noexcept;
  // Relative error of the nominal period, (true − nominal) / nominal, where that period is used: for each
  // interval of a device with a counter and no clock; for counting the missing samples of one with a clock
  // and no counter. 0 for all others, and until it is known.
  [[nodiscard]] double interval_error() const noexcept;

 private:
  using Step = Timeline::Step;
  [[nodiscard]] Timeline::Frame frame_of(const Reading& reading) const noexcept;
  void pass_gap(const Step& step, Increment& out) noexcept;
  void begin_anew() noexcept;
  void label(const Reading& reading, const Step& step, Increment& out) noexcept;
  [[nodiscard]] bool wall_was_set(const Reading& reading) const noexcept;
  [[nodiscard]] bool apart(double late_s, std::int64_t arrival_ns) noexcept;
  [[nodiscard]] double periods_of(const Step& step, bool clocked) noexcept;
  void measure(const Reading& reading, const Step& step, Increment& out) noexcept;
  void hold_channels(const Reading& reading, std::uint64_t samples, Increment& out) noexcept;
  [[nodiscard]] Verdict turn(std::size_t axis, double value, double own_s, Turn& out) noexcept;

  SensorFacts facts_;
  double period_s_;
  // The line through the times of arrival.
  struct Labels {
    FittedClock clock;
    int early = 0;                   // arrivals before the line, in a row
    std::int64_t late_since_ns = 0;  // arrivals have been behind it since then; 0: they are not
    // Recent sample times by a device's own clock, in nominal periods.
    double clocked_periods = 0.0, clocked_samples = 0.0;
  } labels_;
  Timeline timeline_;
  bool started_ = false;
  bool reopened_ = false;
  // The reading before; its channels are kept below.
  struct Last {
    std::int64_t wall_shift_ns = 0, utime_ns = 0, came_ns = 0;
    bool clocked = false;
  } last_;
  // Samples in a row that each came behind a gap, of a device with a clock alone.
  struct Row {
    std::uint64_t gaps = 0;
    double lasts_s = 0.0;
  } row_;
  std::uint64_t sequence_ = 0;
  std::array<PlausibleRate, kMaxAxes> rate_;
  std::array<PlausibleAngle, kMaxAxes> angle_;  // SensorKind::angle
  SensorCheck check_;
  struct Seen {
    std::uint32_t axes = 0;
    std::uint64_t without_others = 0;  // samples that lack nothing but axes that have never been there
  } seen_;
  struct Channels {
    std::array<PlausibleValue, kMaxChannels> plausible;  // of the device's own
    std::array<double, kMaxChannels> value{};
    std::array<float, kMaxChannels> age_s{};
  } channels_;
  IncrementerCounts counts_;
};

}  // namespace ifog
