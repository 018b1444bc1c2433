// SPDX-License-Identifier: Apache-2.0
// Sample times of a device's frames, for the daemon and for all readers of recordings.
//
// Rule: device time if there is one and it does not exceed the elapsed time. Else the counter, with the
// number of rollovers that is nearest to the elapsed time. If counter and elapsed time contradict each
// other, the device restarted, and the gap has as many samples as the elapsed time gives.
//   - Elapsed time is by arrivals on an unslewed clock, from the time when the previous frame was due: a
//   delayed frame shortens only the next interval.
//   - A silence that the counter does not show is a delayed delivery until the next frames arrive at their
//   pace for kStands_s. Then it is a gap, if it is longer than a rollover or than any delivery.
//   - A counter or stamp that goes back slightly, without a silence, is a duplicate or was overtaken.
//   - A single early arrival stamp has no effect; kEarly consecutive ones have.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "drivers/timeline/sample_pace.h"
#include "drivers/timeline/two_devices.h"

namespace ifog {

// Counter positions and values of the last accepted frames, to recognise duplicates, overtaken frames and
// frames of another device.
class RecentFrames {
 public:
  enum class Had : std::uint8_t { no, same, other };
  static constexpr std::uint64_t kMost = 64;

  static std::uint64_t digest_of(std::span<const double> values) noexcept {
    return std::hash<std::string_view>()({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
  }

  [[nodiscard]] std::uint64_t size() const noexcept { return std::min(kept_, kMost); }
  // Tells if a frame was accepted `back` samples before the last one, with the same or other values.
  [[nodiscard]] Had had(std::uint64_t back, std::uint64_t digest) const noexcept {
    Had out = Had::no;
    for (std::uint64_t i = 0; i < size(); ++i)
      if (frames_[i].first + back == place_) out = frames_[i].second == digest ? Had::same : Had::other;
    return out;
  }
  // Adds the next frame, `samples` after the last one.
  void keep(std::uint64_t samples, std::uint64_t digest) noexcept {
    place_ += samples;
    frames_[kept_++ % kMost] = {place_, digest};
  }
  void forget() noexcept { kept_ = 0; }

 private:
  std::uint64_t place_ = 0, kept_ = 0;  // unwrapped counter; number of frames
  std::array<std::pair<std::uint64_t, std::uint64_t>, kMost> frames_{};
};

class Timeline {
 public:
  struct Frame {
    bool counts = false;                     // it has a counter
    std::uint32_t sequence = 0;              // as sent
    bool clocked = false;                    // it has a stamp of the device's clock
    std::int64_t stamp_ns = 0, wrap_ns = 0;  // as sent; rolls over after wrap_ns, 0: never
    std::int64_t arrival_ns = 0;             // on an unslewed clock; 0: unknown
    bool recorded = false;                   // by a log, whose clock may have been set
    std::uint32_t at_once = 0;               // samples in the same read; 0: unknown
    bool reopened = false;                   // the device was reopened since the previous frame
    std::span<const double> values;
  };
  struct Step {
    std::uint64_t samples = 1;  // since the previous frame
    double dt_s = 0.0;          // time of these samples
    bool gap = false;
    bool restarted = false;    // counter or clock jumped: the device restarted
    bool out_of_turn = false;  // a duplicate, overtaken, or of another device: dropped, the rest is unset
    bool clock_moved = false;  // deliveries take longer from now on: labels move, no sample is missing
    double late_s = 0.0;       // delay of the delivery; its arrival does not give its time
    bool by_count = false;     // dt_s is not the change of time_ns
    bool clock_set = false;    // because the device's clock was set while it measured
    bool ambiguous = false;    // missing samples, or the clock was set; undecidable
    std::int64_t time_ns = 0;  // device's clock, unwrapped
  };

  // modulus: of the counter; 0: none. rate_hz: nominal; 0: unknown.
  Timeline(std::uint64_t modulus, double rate_hz) noexcept;

  // For the first frame, or one that does not continue the previous ones. Returns Step::time_ns.
  std::int64_t first(const Frame& frame) noexcept;
  // For each further frame. No allocation, no exception.
  Step next(const Frame& frame) noexcept;
  // The device's clock stood still while it measured: only the sum of its steps is valid.
  [[nodiscard]] bool clock_stood() const noexcept { return ticks_.stood(); }
  // The sequence alternates: two devices send on one line, and frames are dropped.
  [[nodiscard]] bool two_devices() const noexcept { return two_.found(); }

 private:
  // The present frame relative to the previous one.
  struct Look {
    bool counted = false, clocked = false;  // a count, or a device time, is available
    bool timed = false;                     // elapsed times are valid
    bool silent = false;                    // nothing arrived for so long that the device may have been off
    double elapsed_s = 0.0;                 // since the previous frame was due
    double quiet_s = 0.0;                   // since any frame arrived
    double slack_s = 0.0;                   // uncertainty of elapsed_s
    std::uint64_t ahead = 1;                // by the counter, without rollovers
    std::uint64_t counted_samples = 1;      // including rollovers
    double passed_s = 0.0;                  // by the device's clock
    std::int64_t time_ns = 0;
    std::uint64_t digest = 0;

    [[nodiscard]] bool tells() const noexcept { return counted || clocked; }
    // True if claimed_s exceeds the elapsed time.
    [[nodiscard]] bool contradicts(double claimed_s) const noexcept;
  };
  struct Last {
    std::uint32_t sequence = 0;
    bool clocked = false;
    std::int64_t stamp_ns = 0, time_ns = 0;
    std::uint64_t digest = 0;
  };
  // An undecided silence.
  struct Delay {
    bool shown = false;         // the counter shows missing samples in it
    double most_late_s = 0.0;   // at its start
    double least_late_s = 0.0;  // since its start
    std::int64_t least_ns = 0;  // when that last decreased
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
  std::int64_t seen_ns_ = 0;    // last arrival of any frame, accepted or not; 0: unknown
  double owed_s_ = 0.0;         // shift of due_ns_ that no step has reported
  int early_ = 0, strays_ = 0;  // consecutive frames
  std::optional<Delay> delay_;
  double scatter_s_ = 0.0;  // recent largest lateness of deliveries
  double stall_s_ = 0.0;    // recent longest delay that drained
  double each_s_ = 0.0;     // of the last counted sample by the device's clock
};

}  // namespace ifog
