// SPDX-License-Identifier: Apache-2.0
// When a device took each of its frames, decided once for the daemon and for every reader of recordings.
//
// The rule. Device time where there is one and it is not ahead of the elapsed time. Else the counter, with as
// many rollovers as bring it nearest to the elapsed time. Else, where the two contradict each other, the
// elapsed time and a gap of as many samples as that says: the device restarted.
//   - Elapsed time is arrival time on an unslewed clock, counted from when the frame before was due: a frame
//     that was delayed on its way shortens the next interval and no other.
//   - A silence that the counter does not show is a delayed delivery until the frames behind it come at their
//     pace for kStands_s. Then it is a gap, if it is longer than a rollover or than any delivery takes.
//   - A frame whose counter or stamp goes back by little, without a silence, is a duplicate or was overtaken.
//   - A stamp of arrival that is too early by itself moves nothing: kEarly of them in a row do.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "drivers/timeline/recent_frames.h"
#include "drivers/timeline/sample_pace.h"
#include "drivers/timeline/ticks.h"
#include "drivers/timeline/two_devices.h"

namespace ifog {

class Timeline {
 public:
  struct Frame {
    bool counts = false;                     // it has a counter
    std::uint32_t sequence = 0;              // as sent
    bool clocked = false;                    // it has a stamp of the device's clock
    std::int64_t stamp_ns = 0, wrap_ns = 0;  // as sent; it rolls over after wrap_ns, 0: never
    std::int64_t arrival_ns = 0;             // on an unslewed clock; 0: unknown
    bool recorded = false;                   // by a log, whose clock may have been set
    std::uint32_t at_once = 0;               // samples in the same read; 0: unknown
    bool reopened = false;                   // the device was closed and opened since the frame before
    std::span<const double> values;
  };
  struct Step {
    std::uint64_t samples = 1;  // since the frame before
    double dt_s = 0.0;          // they took
    bool gap = false;
    bool restarted = false;    // counter or clock jumped: the device was switched off and on
    bool out_of_turn = false;  // a duplicate, overtaken, or of another device: dropped, all else is unset
    bool clock_moved = false;  // deliveries take longer from here on: labels follow, no sample is missing
    double late_s = 0.0;       // delayed by this much on its way; its arrival tells nothing of its time
    bool by_count = false;     // dt_s is not what time_ns moved by
    bool clock_set = false;    // because the device's clock was set while it measured
    bool ambiguous = false;    // missing samples, or its clock was set: nothing known tells which
    std::int64_t time_ns = 0;  // the device's clock over its rollovers
  };

  // modulus: the counter rolls over after it; 0: the device has none. rate_hz: nominal; 0: unknown.
  Timeline(std::uint64_t modulus, double rate_hz) noexcept;

  // The first frame, or one that does not join those before. Returns its Step::time_ns.
  std::int64_t first(const Frame& frame) noexcept;
  // The next. No allocation, no exception.
  Step next(const Frame& frame) noexcept;
  // The device's clock has stood still while it measured: only the sum of its steps tells time.
  [[nodiscard]] bool clock_stood() const noexcept { return ticks_.stood(); }
  // The sequence runs to and fro: two devices send on one line, and no frame is accepted.
  [[nodiscard]] bool two_devices() const noexcept { return two_.found(); }

 private:
  // The frame at hand against the one before.
  struct Look {
    bool counted = false, clocked = false;  // there is a count, a time of the device to go by
    bool timed = false;                     // elapsed times tell something
    bool silent = false;                    // nothing came for so long that the device may have been off
    double elapsed_s = 0.0;                 // since the frame before was due
    double quiet_s = 0.0;                   // since any frame came
    double slack_s = 0.0;                   // to what elapsed_s is known
    std::uint64_t ahead = 1;                // of the counter, less rollovers
    std::uint64_t counted_samples = 1;      // with them
    double passed_s = 0.0;                  // of the device's clock
    std::int64_t time_ns = 0;
    std::uint64_t digest = 0;

    // claimed_s is more than the elapsed time holds.
    [[nodiscard]] bool contradicts(double claimed_s) const noexcept;
  };
  struct Last {
    std::uint32_t sequence = 0;
    bool clocked = false;
    std::int64_t stamp_ns = 0, time_ns = 0;
    std::uint64_t digest = 0;
  };
  // A silence that is not decided yet.
  struct Delay {
    bool shown = false;         // the counter shows that samples are missing in it
    double least_late_s = 0.0;  // since it began
    std::int64_t least_ns = 0;  // when that was last undercut
  };
  using Had = RecentFrames::Had;

  [[nodiscard]] double slack_s(double time_s) const noexcept;
  [[nodiscard]] Look look(const Frame& frame) const noexcept;
  void look_at_arrival(const Frame& frame, Look& now) const noexcept;
  void look_at_clock(const Frame& frame, Look& now) const noexcept;
  [[nodiscard]] std::uint64_t rolled_over(const Look& now, bool reopened) const noexcept;
  [[nodiscard]] bool out_of_turn(const Frame& frame, const Look& now) const noexcept;
  [[nodiscard]] bool clock_is_wrong(const Look& now) const noexcept;
  [[nodiscard]] std::uint64_t samples_by_clock(const Look& now) const noexcept;
  bool by_clock(const Frame& frame, const Look& now, Step& step) noexcept;
  void by_counter(const Frame& frame, const Look& now, Step& step) const noexcept;
  void by_elapsed(const Frame& frame, const Look& now, Step& step) noexcept;
  void restart(const Look& now, Step& step) const noexcept;
  [[nodiscard]] Step leave_out(const Frame& frame) noexcept;
  void settle(const Frame& frame, const Look& now, Step& step) noexcept;
  void meet_arrival(const Frame& frame, const Look& now, Step& step) noexcept;
  void judge_delay(const Frame& frame, const Look& now, double late_s, Step& step) noexcept;
  void end_delay(const Frame& frame, const Look& now, double late_s, Step& step) noexcept;
  void follow(double late_s, std::int64_t arrival_ns) noexcept;
  void learn(const Frame& frame, const Look& now, const Step& step) noexcept;
  void keep(const Frame& frame, std::int64_t time_ns, std::uint64_t samples, std::uint64_t digest) noexcept;

  std::uint64_t modulus_;
  SamplePace pace_;
  Ticks ticks_;
  TwoDevices two_;
  RecentFrames recent_;
  Last last_;
  std::int64_t due_ns_ = 0;     // when the last frame was due; 0: no arrival is known
  std::int64_t seen_ns_ = 0;    // when any frame last arrived, accepted or not; 0: unknown
  double owed_s_ = 0.0;         // by which due_ns_ moved and which no step has reported
  int early_ = 0, strays_ = 0;  // frames in a row
  std::optional<Delay> delay_;
  double scatter_s_ = 0.0;  // most that deliveries are late by, of late
  double each_s_ = 0.0;     // of the last counted sample by the device's clock
};

}  // namespace ifog
