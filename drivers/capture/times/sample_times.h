// SPDX-License-Identifier: Apache-2.0
// When a recording's samples were taken, on one axis of seconds: the times that every command prints for them
// and that --from and --to mean.
//
// The first of these that the samples have:
//   - the device's clock, over its wraps, and over where it was set while the device counted on;
//   - the sequence counter, unwrapped, over the nominal rate, from 0;
//   - the arrival times, from 0. Where several samples arrive at once or arrivals scatter, samples are spaced
//     evenly at the nominal rate, which slowly follows the arrivals; delayed samples are spaced evenly, too;
//   - the number of the sample over the nominal rate, from 0.
// Where a log's own times are kept, they are what the samples are known by: arrival times stand as they are,
// and a counter counts on from the first of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "drivers/capture/times/time_stamps.h"
#include "drivers/ifog/driver.h"
#include "drivers/timeline/timeline.h"

namespace ifog {

// What the times say of the samples.
struct SampleCounts {
  std::size_t missing = 0;     // were not there by the device's counter, or by its clock where it has none
  std::size_t ambiguous = 0;   // of these: the clock may have been set instead, and nothing decides
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
    double elapsed_s = 0.0;  // since the sample before; NaN of the first
    double period_s = 0.0;   // of the sample itself, also behind a gap
    bool restarted = false;  // the device or the recording restarted before this sample
  };
  // nullopt: a duplicate, or overtaken by a later one. Throws std::runtime_error with one line when time
  // does not go on (the sample's number, both times, the cause), or where there is none.
  std::optional<Stamped> next(const ifog_sample& sample);

  // The next sample does not continue those before: its clock and counter may have restarted. The arrival
  // times, which must be known, say how much later it is.
  void discontinuity() { broken_ = true; }
  // The driver's options change with the next sample. If they change its clocks, it does not continue the
  // samples before.
  void go_on_as(const ifog_description& description);
  // From here on a clock that jumps back means that the device restarted, even if that clock has no rollover.
  // Without this call it is refused, because a wrong driver looks alike.
  void allow_restarts() { restarts_ = true; }
  // The arrival times are the stamps of a log whose lines all have one, that of a stamp of zero being
  // zero_ns. Nothing: they have none. Before the first sample.
  void keep_stamps(std::optional<std::int64_t> zero_ns) { arrivals_.zero_of_stamps_ns = zero_ns; }

  // What times are counted from; known from the first sample on.
  [[nodiscard]] const TimeOrigin& origin() const { return origin_; }
  [[nodiscard]] const SampleCounts& counts() const { return counts_; }

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
  TimeOrigin device_from_;      // of the device's clock, that its times are counted from
  std::int64_t device_ns_ = 0;  // the device's clock at the sample at hand, over its wraps
  std::uint64_t count_ = 0;     // the unwrapped counter, or the number of the sample
  struct Arrivals {
    std::int64_t first_ns = 0, last_ns = 0;
    bool bunched = false;  // several samples have one time of arrival, or times that scatter
    std::optional<std::int64_t> zero_of_stamps_ns;
  } arrivals_;
  std::size_t accepted_ = 0;
  SampleCounts counts_;
  double last_s_ = 0.0;
  double offset_s_ = 0.0;  // of the clock since the last discontinuity
  bool broken_ = false, restarts_ = false;
};

}  // namespace ifog
