// SPDX-License-Identifier: Apache-2.0
// The one place that decides of each sample of a device that counts or has a clock: whether it is new, came
// again or late, comes behind a gap, or from a device that was switched off and on; and what the device's
// stamp, which goes round, then stands for. The daemon and every command that reads recordings ask here.
//
// A sample that comes again, or after one that follows it, is left out: its place is that of one that came,
// with the very values, or of one that is missing. One that has another's place and other values is of a
// device that began anew; its time begins with its stamp, and no round is made of it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "drivers/ifog/arrivals.h"
#include "drivers/ifog/clock_steps.h"
#include "drivers/ifog/device_count.h"
#include "drivers/ifog/mixed_devices.h"
#include "drivers/ifog/prompt_arrivals.h"
#include "drivers/ifog/recent_frames.h"
#include "drivers/ifog/rolling_stamp.h"

namespace ifog {

class DeviceTimeline {
 public:
  struct Frame {
    bool counts = false;         // it has a counter
    std::uint32_t sequence = 0;  // as sent
    bool clocked = false;        // it has a stamp
    RollingStamp::Stamp stamp;
    std::int64_t arrival_ns = 0;  // on a clock that nobody sets; 0: not known
    bool reopened = false;        // the device was closed and opened in between
    std::span<const double> values;
  };
  struct Step {
    std::uint64_t samples = 1;  // since the frame before
    double dt_s = 0.0;
    bool gap = false;
    bool restarted = false;
    bool out_of_turn = false;  // it came again, or late: left out, and all else here says nothing
    bool clock_moved = false;  // as in DeviceCount::Step
    double late_s = 0.0;       // likewise
    bool same_gap = false;     // likewise
    bool undecided = false;    // likewise
    bool by_count = false;     // dt_s is by the counter, or the rate, and not what time_ns has moved on by
    bool clock_set = false;    // that is because the device's clock was set while it measured on
    bool untold = false;       // samples are missing, or it was set: nothing that is known tells which
    std::int64_t time_ns = 0;  // of the device's clock, carried on over its wraps
  };

  // modulus: the counter's; 0: it has none. rate_hz: nominal; 0: not known.
  DeviceTimeline(std::uint64_t modulus, double rate_hz, bool on_bus = false) noexcept
      : modulus_(modulus),
        rate_known_(rate_hz > 0.0),
        period_s_(rate_hz > 0.0 ? 1.0 / rate_hz : 1.0),
        count_(modulus > 0 ? modulus : 1, period_s_, on_bus),
        clock_steps_(period_s_),
        mixed_(static_cast<std::int64_t>(modulus), rate_known_ ? period_s_ : 0.0) {}

  // Whether it decides of this frame: else there is neither counter nor clock to go by.
  [[nodiscard]] bool tells(const Frame& frame) const noexcept {
    return counted(frame) || (frame.clocked && last_clocked_);
  }
  // The first, or one that does not join those before.
  std::int64_t first(const Frame& frame) noexcept {
    mixed_.first(place(frame));
    return begin(frame);
  }
  // The next; it is taken into account.
  Step next(const Frame& frame) noexcept {
    if (places(frame) && !mixed_.plain(place(frame))) [[unlikely]] {
      const MixedDevices::Says says = mixed_.next({place(frame), frame.arrival_ns, digest_of(frame.values)});
      if (says == MixedDevices::Says::left) return leave_out(frame);
      if (says == MixedDevices::Says::anew) return anew(frame);
    }
    const double elapsed_s = arrivals_.elapsed_s(frame.arrival_ns);
    const Look now = look_at(frame, elapsed_s, proposed(frame, elapsed_s));
    Step step = counted(frame) ? by_counter(frame, now) : by_clock(frame, now);
    if (step.out_of_turn) return leave_out(frame);
    step.time_ns = now.time_ns;
    if (step.restarted) {
      recent_.forget();
      clock_steps_.restart();
      prompt_.forget();
    }
    if (step.restarted || clock_jumped(frame, now)) step.time_ns = frame.stamp.ns;
    Look taken = now;
    taken.time_ns = step.time_ns;
    keep(frame, taken, step.dt_s);
    return step;
  }
  // Its clock has stood still while it measured: only the sum of its steps says how much has passed.
  [[nodiscard]] bool clock_stood() const noexcept { return clock_steps_.stood(); }
  // Frames of two devices come, and none is taken.
  [[nodiscard]] bool mixed() const noexcept { return mixed_.two(); }

 private:
  static constexpr double kShortStep_s = 1.0;   // of a clock that is set while it runs
  static constexpr double kSamplesLate = 64.0;  // at most
  static constexpr double kSilence_s = 2.0;     // nothing is late behind it
  static constexpr double kNoPause_s = 0.25;    // no device begins anew within it
  static constexpr double kSamePlace = 0.75;    // of a period: none was measured so near to another
  static constexpr double kTickTells = 0.2;     // periods beside those that were left out
  static constexpr double kRateOff = 0.05;      // of the stated one
  static constexpr int kTicksTell = 3;
  static constexpr std::uint64_t kTellsCountsApart = 128;  // mixed_devices.h

  struct Look {
    double elapsed_s = -1.0;
    std::int64_t time_ns = 0;
    std::uint64_t digest = 0;
    DeviceCount::Frame count;
  };

  [[nodiscard]] bool counted(const Frame& frame) const noexcept { return frame.counts && modulus_ > 0; }
  // Whether its counter tells frames of two devices apart.
  [[nodiscard]] bool places(const Frame& frame) const noexcept {
    return frame.counts && modulus_ >= kTellsCountsApart;
  }
  [[nodiscard]] static std::int64_t place(const Frame& frame) noexcept {
    return static_cast<std::int64_t>(frame.sequence);
  }
  std::int64_t begin(const Frame& frame) noexcept {
    arrivals_.forget();
    recent_.forget();
    clock_steps_.restart();
    prompt_.forget();
    const Look now = look_at(frame, -1.0, frame.stamp.ns);
    count_.first(now.count);
    keep(frame, now, period_s_);
    return frame.stamp.ns;
  }
  Step leave_out(const Frame& frame) noexcept {
    Step step;
    step.out_of_turn = true;
    if (frame.arrival_ns > 0) seen_ns_ = frame.arrival_ns;
    return step;
  }
  // Of another device than what was taken, for all that is known.
  Step anew(const Frame& frame) noexcept {
    const double elapsed_s = arrivals_.elapsed_s(frame.arrival_ns);
    Step step;
    step.restarted = step.gap = true;
    step.samples = elapsed_s > 0.0 && rate_known_ ? at_least_one(elapsed_s / period_s_) : 1;
    step.dt_s = static_cast<double>(step.samples) * period_s_;
    step.time_ns = begin(frame);
    return step;
  }
  [[nodiscard]] std::int64_t proposed(const Frame& frame, double elapsed_s) const noexcept {
    if (!last_clocked_) return frame.stamp.ns;
    std::optional<double> counted_s;
    const double grain_s = clock_steps_.grain_s();
    if (counted(frame) && rate_known_) counted_s = count_.ahead_s(frame.sequence, grain_s);
    return stamp_.look(frame.stamp, {elapsed_s, rate_known_ ? period_s_ : 0.0, quiet_s(frame, elapsed_s),
                                     counted_s, count_.round_s(grain_s)});
  }
  // Since any frame came, also one that was left out.
  [[nodiscard]] double quiet_s(const Frame& frame, double elapsed_s) const noexcept {
    if (frame.arrival_ns <= 0 || seen_ns_ <= 0) return elapsed_s;
    return std::max(0.0, static_cast<double>(frame.arrival_ns - seen_ns_) * 1e-9);
  }
  [[nodiscard]] double passed_s(const Look& now) const noexcept {
    return static_cast<double>(ns_between(stamp_.time_ns(), now.time_ns)) * 1e-9;
  }

  [[nodiscard]] Look look_at(const Frame& frame, double elapsed_s, std::int64_t time_ns) const noexcept {
    Look now{elapsed_s, time_ns, digest_of(frame.values), {}};
    DeviceCount::Frame& count = now.count;
    count.sequence = frame.sequence;
    count.clocked = frame.clocked;
    count.time_ns = time_ns;
    count.arrival_ns = frame.arrival_ns;
    count.reopened = frame.reopened;
    count.grain_s = clock_steps_.grain_s();
    count.digest = now.digest;
    count.quiet_s = quiet_s(frame, elapsed_s);
    return now;
  }

  [[nodiscard]] Step by_counter(const Frame& frame, const Look& now) noexcept {
    DeviceCount::Step counted = count_.look(now.count);
    Step step;
    // The same counter again, too soon for a full round. CAN may deliver a frame twice; a device whose
    // counter stands still yet measures is followed.
    step.out_of_turn = counted.out_of_turn || (counted.samples == 0 && now.digest == last_digest_);
    if (step.out_of_turn) return step;
    counted.samples = std::max<std::uint64_t>(counted.samples, 1);
    if (!counted.restarted && frame.clocked && last_clocked_) {
      const std::int64_t passed_ns = ns_between(stamp_.time_ns(), now.time_ns);
      // Rounds that were lost a while ago, as the times of arrival tell now: of them this step of the clock
      // knows nothing.
      const bool rounds = !counted.by_clock && counted.samples >= modulus_;
      if (!rounds && (passed_ns == 0 || counted.by_clock)) {
        const ClockSteps::Step passed = clock_steps_.take(passed_ns, counted.samples);
        if (clock_steps_.coarse()) counted.dt_s = passed.dt_s;
      } else {
        step.by_count = true;
        step.clock_set = !rounds && clock_steps_.known();
        clock_steps_.jumped();
      }
    }
    count_.take(now.count, counted);
    step.samples = counted.samples;
    step.dt_s = counted.dt_s;
    step.gap = counted.gap;
    step.restarted = counted.restarted;
    step.clock_moved = counted.clock_moved;
    step.late_s = counted.late_s;
    step.same_gap = counted.same_gap;
    step.undecided = counted.undecided;
    step.untold = frame.clocked && now.elapsed_s < 0.0 && step.samples > modulus_;
    return step;
  }

  [[nodiscard]] Step by_clock(const Frame& frame, const Look& now) noexcept {
    Step step;
    const std::int64_t passed_ns = ns_between(stamp_.time_ns(), now.time_ns);
    const double passed_s = this->passed_s(now);
    step.out_of_turn = !frame.reopened && (passed_ns == 0 ? same_again(now) : passed_ns < 0 && late(now));
    if (step.out_of_turn) {
      if (passed_ns == 0) ++left_out_;
      return step;
    }
    learn_ticks(passed_s);
    standing_ = passed_ns == 0 ? standing_ + 1 : 0;
    if (was_set(frame, now, passed_s)) {
      step.dt_s = period_s_;
      step.by_count = step.clock_set = true;
      clock_steps_.jumped();
      return step;
    }
    const bool ahead =
        now.elapsed_s >= 0.0 &&
        prompt_.ahead(passed_s, now.elapsed_s, kShortStep_s + PromptArrivals::kDoubt * passed_s);
    if (passed_ns < 0 || ahead || (now.elapsed_s >= 0.0 && ifog::restarted(passed_s, now.elapsed_s))) {
      step.restarted = step.gap = true;
      step.samples = now.elapsed_s > 0.0 && rate_known_ ? at_least_one(now.elapsed_s / period_s_) : 1;
      step.dt_s = static_cast<double>(step.samples) * period_s_;
      return step;
    }
    step.dt_s = passed_s;
    if (rate_known_) {
      const ClockSteps::Step passed = clock_steps_.take(passed_ns, 0);
      step.samples = passed.samples;
      step.dt_s = passed.dt_s;
    }
    step.gap = step.samples > 1 || frame.reopened;
    // A stamp that jumps is all that there is of samples that are missing and of a clock that was set.
    step.untold = step.samples > 1 && (now.elapsed_s < 0.0 || !prompt_.at_its_pace());
    return step;
  }
  // A clock alone that jumps back while the device measures on, or ahead of when its samples come.
  [[nodiscard]] bool was_set(const Frame& frame, const Look& now, double passed_s) const noexcept {
    if (frame.reopened || now.elapsed_s < 0.0 || !rate_known_) return false;
    const bool goes_on = now.count.quiet_s <= kNoPause_s + 2.0 * period_s_;
    const double slack_s = 2.0 * period_s_ + PromptArrivals::kDoubt * passed_s + clock_steps_.grain_s();
    return passed_s < 0.0 ? goes_on : prompt_.ahead(passed_s, now.elapsed_s, slack_s) && goes_on;
  }
  // With the stamp of the frame before. Of a clock of coarse ticks it may be another that measured the same,
  // but for what is more of them than a tick holds.
  [[nodiscard]] bool same_again(const Look& now) const noexcept {
    return now.digest == last_digest_ &&
           (!clock_steps_.stood() || standing_ >= clock_steps_.most_in_a_tick());
  }
  // Of one that measures the same again and again: what was left out was not sent twice where its clock then
  // went on by as much as such samples take, and that several times in a row.
  void learn_ticks(double passed_s) noexcept {
    const auto left_out = static_cast<double>(std::exchange(left_out_, 0));
    if (left_out == 0.0 || !rate_known_ || clock_steps_.stood()) return;
    const double periods = passed_s / period_s_;
    const bool fits =
        periods > (1.0 - kRateOff) * left_out + kTickTells && periods < (1.0 + kRateOff) * left_out + 2.0;
    ticks_seen_ = fits ? ticks_seen_ + 1 : 0;
    if (ticks_seen_ >= kTicksTell) clock_steps_.stands();
  }
  [[nodiscard]] bool late(const Look& now) const noexcept {
    if (!rate_known_ || -passed_s(now) > kSamplesLate * period_s_) return false;
    if (now.count.quiet_s > std::max(kSilence_s, 2.0 * period_s_)) return false;
    const auto near_ns = static_cast<std::int64_t>(kSamePlace * period_s_ * 1e9);
    const RecentFrames::Had had = recent_.at_time(now.time_ns, near_ns, now.digest);
    return had != RecentFrames::Had::other || clock_steps_.coarse();
  }
  // Of a device that counts on: its clock was set.
  [[nodiscard]] bool clock_jumped(const Frame& frame, const Look& now) const noexcept {
    if (!frame.clocked || !last_clocked_ || frame.stamp.wrap_ns <= 0) return false;
    const double passed_s = this->passed_s(now);
    return passed_s < -kShortStep_s || (now.elapsed_s >= 0.0 && ifog::restarted(passed_s, now.elapsed_s));
  }

  void keep(const Frame& frame, const Look& now, double dt_s) noexcept {
    if (!counted(frame)) recent_.add(0, now.time_ns, now.digest);
    if (frame.clocked) stamp_.take(frame.stamp, now.time_ns);
    if (counted(frame)) count_.keep_time(now.time_ns);
    last_clocked_ = frame.clocked;
    last_digest_ = now.digest;
    if (now.elapsed_s >= 0.0) prompt_.came(now.elapsed_s, dt_s);
    arrivals_.came(frame.arrival_ns, dt_s);
    seen_ns_ = frame.arrival_ns;
  }

  std::uint64_t modulus_;
  bool rate_known_;
  double period_s_;
  DeviceCount count_;
  ClockSteps clock_steps_;
  MixedDevices mixed_;
  RollingStamp stamp_;
  Arrivals arrivals_;
  PromptArrivals prompt_;
  RecentFrames recent_;  // of a device with a clock alone; the count keeps its own
  bool last_clocked_ = false;
  std::uint64_t last_digest_ = 0, standing_ = 0;  // standing_: frames with this same stamp before
  std::uint64_t left_out_ = 0;                    // with the stamp and the values of the one before
  int ticks_seen_ = 0;                            // of a clock that stood, in a row
  std::int64_t seen_ns_ = 0;                      // arrival of the last frame, used or not; 0: not known
};

}  // namespace ifog
