// SPDX-License-Identifier: Apache-2.0
// Sample times of a recording in seconds: as printed by all commands and as used by --from and --to.
//
// The first available one of:
//   - the device's clock, unwrapped, also across a change of the clock if the counter continues;
//   - the sequence counter, unwrapped, / nominal rate, from 0;
//   - the arrival times, from 0. If samples arrive together or irregularly they are spaced at the nominal
//   rate, which slowly follows the arrivals; delayed samples are spaced evenly, too;
//   - the number of the sample / nominal rate, from 0.
// If a log's own times are kept, arrival times are used unchanged, and a counter continues from the first
// one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "drivers/capture/times/time_stamps.h"
#include "drivers/ifog/driver.h"
#include "drivers/timeline/timeline.h"

namespace ifog {

struct SampleCounts {
  std::size_t missing = 0;     // missing by the device's counter, or by its clock without a counter
  std::size_t ambiguous = 0;   // of these: ambiguous, because the clock may have been set instead
  std::size_t restarts = 0;    // the counter or the clock jumped back without a discontinuity
  std::size_t clock_sets = 0;  // the clock was set while the counter, which then gives the time, continued
  std::size_t repeated = 0;    // dropped as duplicates or because a later one had arrived
  std::size_t mixed = 0;       // dropped because two devices send on one line
};

class SampleTimes {
 public:
  explicit SampleTimes(const ifog_description& description);

  struct Stamped {
    double since_s = 0.0;    // since origin()
    double elapsed_s = 0.0;  // since the previous sample; NaN for the first
    double period_s = 0.0;   // of the sample itself, also after a gap
    bool restarted = false;  // the device or the recording restarted before this sample
  };
  // nullopt: a duplicate, or overtaken by a later one. Throws std::runtime_error with one line if time does
  // not increase (the sample's number, both times, the cause), or if there is none.
  std::optional<Stamped> next(const ifog_sample& sample);

  // The next sample does not continue those before; clock and counter may have restarted. Arrival times,
  // which must be known, give the time between.
  void discontinuity() { broken_ = true; }
  // Changes the driver's options from the next sample on, which does not continue the samples before.
  void go_on_as(const ifog_description& description);
  // From now on a clock that jumps back means that the device restarted, even without rollover. By default it
  // is an error, because a wrong driver looks similar.
  void allow_restarts() { restarts_ = true; }
  // The arrival times are stamps of a log in which every line has one; zero_ns: that of a stamp of zero.
  // nullopt: no stamps. To be called before the first sample.
  void keep_stamps(std::optional<std::int64_t> zero_ns) { arrivals_.zero_of_stamps_ns = zero_ns; }

  // Origin of the times, and the last one, since then; known from the first sample on.
  [[nodiscard]] const TimeOrigin& origin() const { return origin_; }
  [[nodiscard]] double last_s() const { return last_s_; }
  [[nodiscard]] const SampleCounts& counts() const { return counts_; }
  // Time by the device's clock, in use so far, per time of as many samples at the nominal rate; 1: unknown.
  [[nodiscard]] double clock_runs() const {
    const bool known = clock_ == Clock::device && count_ > 0 && description_.nominal_rate_hz > 0.0;
    return known ? (last_s_ - first_s_) / static_cast<double>(count_) * description_.nominal_rate_hz : 1.0;
  }

 private:
  enum class Clock { undecided, device, counter, arrival, number };
  void choose_clock(const ifog_sample& sample);
  void count_from(const ifog_sample& sample);
  [[nodiscard]] Timeline::Frame frame_of(const ifog_sample& sample) const;
  [[nodiscard]] double seconds(const ifog_sample& sample) const;
  [[nodiscard]] double spread(const ifog_sample& sample, const Timeline::Step& step, double arrived_s);
  void begin_again(const ifog_sample& sample);
  void refuse(double now) const;

  ifog_description description_;
  Clock clock_ = Clock::undecided;
  Timeline timeline_;
  TimeOrigin origin_;
  TimeOrigin device_from_;      // origin of the device's clock
  std::int64_t device_ns_ = 0;  // device's clock at the present sample, unwrapped
  std::uint64_t count_ = 0;     // unwrapped counter, or number of the sample
  struct Arrivals {
    std::int64_t first_ns = 0, last_ns = 0;
    bool bunched = false;  // several samples have one arrival time, or arrivals scatter
    std::optional<std::int64_t> zero_of_stamps_ns;
  } arrivals_;
  std::size_t accepted_ = 0;
  SampleCounts counts_;
  double first_s_ = 0.0, last_s_ = 0.0;
  double offset_s_ = 0.0;  // of the clock since the last discontinuity
  bool broken_ = false, restarts_ = false;
};

}  // namespace ifog
