// SPDX-License-Identifier: Apache-2.0
// Converts samples to angle increments: unwraps counters and angles, detects gaps, fits the time.
//
// Time step, in order of preference: the device's clock; nominal period times the difference of the device's
// counter; the fitted period for a device with neither. So for devices that count, a replay of the same
// frames gives the same bits, regardless of arrival times. A clock against which arrivals and the number of
// samples at the nominal rate agree (of another unit, stopped) is not used any more.
//
// New, duplicate and overtaken samples, and the number of missing ones: drivers/timeline/timeline.h.
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
  std::uint64_t samples = 0;
  std::uint64_t gaps = 0;       // places with missing samples
  std::uint64_t missing = 0;    // missing samples
  std::uint64_t ambiguous = 0;  // of those: ambiguous, as the device's clock may have been set instead
  std::uint64_t repeated = 0;   // samples dropped as duplicates or because a later one had arrived
  std::uint64_t mixed = 0;      // of those: two devices send on one line, and both are dropped
  std::uint64_t restarts = 0;   // the device restarted: its counter or clock jumped back
  // Samples with an invalid axis. An axis that has never been valid may not exist; its missing values count
  // from its first valid one.
  std::uint64_t invalid = 0;
  std::uint64_t saturated = 0;            // of those: at or beyond full scale
  std::uint64_t implausible = 0;          // of those: marked valid, but implausible
  std::uint64_t channel_implausible = 0;  // implausible values of channels; the last value is held
  std::uint64_t clock_steps = 0;          // times the wall clock was set: only the labels moved
  std::uint64_t sensor_clock_sets = 0;    // times the device's clock was set while it measured
  std::uint64_t pauses = 0;               // times the labels moved because the device had paused
};

class Incrementer {
 public:
  // facts.nominal_rate_hz > 0; the caller has checked it.
  explicit Incrementer(const SensorFacts& facts) noexcept;

  // Converts a reading. False: the sample is a duplicate (counted) and `out` is unchanged. No allocation, no
  // exception.
  bool next(const Reading& reading, Increment& out) noexcept;
  // The device was closed and opened: a gap of unknown length precedes the next sample.
  void discontinuity() noexcept { before_.reopened = true; }

  [[nodiscard]] const IncrementerCounts& counts() const noexcept { return counts_; }
  // Bits of the axes that have been valid at least once.
  [[nodiscard]] std::uint32_t axes_seen() const noexcept { return seen_.axes; }
  // Two devices send on one line; frames are dropped.
  [[nodiscard]] bool mixed() const noexcept { return timeline_.two_devices(); }
  // Relative difference of fitted and nominal period, 1e-6; 0 until the line has settled.
  [[nodiscard]] double clock_offset_ppm() const noexcept;
  // Relative error of the nominal period by arrivals, (true − nominal) / nominal, where it is used: for each
  // interval of a device with a counter and no clock, or for missing samples if each sample seems to follow
  // some. 0 for others, and until it is known.
  [[nodiscard]] double interval_error() const noexcept { return stretch_.interval_error; }
  // Time by the device's clock per time of arrival, of a clock that is not used any more; nullopt: it is used.
  [[nodiscard]] std::optional<double> refused_clock() const noexcept { return refused_clock_; }

 private:
  using Step = Timeline::Step;
  [[nodiscard]] Timeline::Frame frame_of(const Reading& reading) const noexcept;
  void look_at_rate(const Timeline::Frame& frame, const Step& now) noexcept;
  void look_at_clock(const Step& now, double lasts_s) noexcept;
  void pass_gap(const Step& step, Increment& out) noexcept;
  void restart() noexcept;
  void label(const Reading& reading, const Step& step, Increment& out) noexcept;
  [[nodiscard]] bool wall_was_set(const Reading& reading) const noexcept;
  [[nodiscard]] bool apart(double late_s, std::int64_t arrival_ns) noexcept;
  [[nodiscard]] double periods_of(const Step& step, bool clocked) noexcept;
  void measure(const Reading& reading, const Step& step, Increment& out) noexcept;
  void hold_channels(const Reading& reading, std::uint64_t samples, Increment& out) noexcept;
  [[nodiscard]] Verdict turn(std::size_t axis, double value, double own_s, Turn& out) noexcept;

  SensorFacts facts_;
  double period_s_;
  // Line through the arrival times.
  struct Labels {
    FittedClock clock;
    int early = 0;                   // consecutive arrivals before the line
    std::int64_t late_since_ns = 0;  // start of arrivals after the line; 0: none
    // Recent sample times by the device's clock, in nominal periods.
    double clocked_periods = 0.0, clocked_samples = 0.0;
  } labels_;
  Timeline timeline_;
  std::optional<double> refused_clock_;
  // What precedes the next reading.
  struct Before {
    bool started = false;   // any reading
    bool timeline = false;  // one of timeline_
    bool reopened = false;  // and the device was closed and opened since
  } before_;
  // Previous reading; its channels are kept below.
  struct Last {
    std::int64_t wall_shift_ns = 0, utime_ns = 0, read_ns = 0;
  } last_;
  // From which the rate is measured.
  struct Stretch {
    std::int64_t begin_ns = 0, begin_clock_ns = 0;
    std::uint64_t frames = 0, gaps = 0, samples = 0, by_count = 0;  // after the first frame
    double sum_s = 0.0;                                             // of the intervals
    double interval_error = 0.0;
  } stretch_;
  std::uint64_t sequence_ = 0;
  std::array<PlausibleRate, kMaxAxes> rate_;
  std::array<PlausibleAngle, kMaxAxes> angle_;  // SensorKind::angle
  SensorCheck check_;
  struct Seen {
    std::uint32_t axes = 0;
    std::uint64_t without_others = 0;  // samples that lack only axes that have never been valid
  } seen_;
  struct Channels {
    std::array<PlausibleValue, kMaxChannels> plausible;  // of the device's own channels
    std::array<double, kMaxChannels> value{};
    std::array<float, kMaxChannels> age_s{};
  } channels_;
  IncrementerCounts counts_;
};

}  // namespace ifog
