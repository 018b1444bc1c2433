// SPDX-License-Identifier: Apache-2.0
#include "drivers/timeline/timeline.h"

#include <algorithm>
#include <cmath>

#include "drivers/system/nanoseconds.h"

namespace ifog {
namespace {

constexpr double kSilence_s = 0.25;     // no device restarts faster
constexpr double kPrompt_s = 0.05;      // scheduling and delay of an adapter
constexpr double kAdapter_s = 0.02;     // USB adapters collect bytes for 16 ms
constexpr double kLatest_s = 2.0;       // a delivery later than this is a gap
constexpr double kStands_s = 1.0;       // a delayed line shows within this time that it drains
constexpr double kShrinks_s = 0.03;     // by reducing its delay by this
constexpr int kEarly = 8, kStrays = 8;  // consecutive frames; a single damaged stamp or counter has no effect
constexpr double kClocksApart = 0.01;  // difference of device clock and counter, relative to the time between
constexpr double kNoSetting_s = 60.0;  // a larger jump of only the clock means it was set
constexpr double kStoodStill = 8.0;    // in sample times; a larger step means the device stood still

double seconds(std::int64_t ns) noexcept { return static_cast<double>(ns) * 1e-9; }
// Not read together with those that came before it.
bool alone(const Timeline::Frame& frame) noexcept { return frame.at_once > 0 && frame.at_once <= 2; }
std::int64_t nanoseconds(double s) noexcept { return std::llround(std::clamp(s, -9e9, 9e9) * 1e9); }

}  // namespace

Timeline::Timeline(std::uint64_t modulus, double rate_hz) noexcept
    : modulus_(modulus), pace_(rate_hz), ticks_(pace_.nominal_s()) {}

// Uncertainty of a time from arrivals.
double Timeline::slack_s(double time_s) const noexcept {
  return kAdapter_s + 2.0 * scatter_s_ + pace_.doubt(scatter_s_) * std::max(0.0, time_s);
}

std::int64_t Timeline::first(const Frame& frame) noexcept {
  delay_.reset();
  early_ = strays_ = 0;
  due_ns_ = frame.arrival_ns;
  ticks_.jumped();
  recent_.forget();
  keep(frame, frame.stamp_ns, 0, RecentFrames::digest_of(frame.values));
  return frame.stamp_ns;
}

Timeline::Step Timeline::next(const Frame& frame) noexcept {
  const Look now = look(frame);
  Step step;
  if (now.counted) {
    // A frame that fills a missing position, or comes twice, is of the tracked device.
    const bool was_found = two_.found();
    const std::uint64_t back = modulus_ - now.ahead;
    two_.saw(frame.sequence, modulus_,
             now.ahead == 0 || (back < recent_.size() && recent_.had(back, now.digest) != Had::other));
    if (two_.found()) return leave_out(frame);
    if (was_found) {  // the accepted frames may have been of another device
      restart(now, step);
      step.time_ns = first(frame);
      return step;
    }
  }
  if (out_of_turn(frame, now)) return leave_out(frame);
  step.gap = frame.reopened;
  step.time_ns = now.time_ns;
  if (!by_clock(frame, now, step)) now.counted ? by_counter(frame, now, step) : by_elapsed(frame, now, step);
  strays_ = step.out_of_turn ? strays_ + 1 : 0;
  if (step.out_of_turn) return leave_out(frame);
  settle(frame, now, step);
  return step;
}

Timeline::Step Timeline::leave_out(const Frame& frame) noexcept {
  if (frame.arrival_ns > 0) seen_ns_ = frame.arrival_ns;
  Step step;
  step.out_of_turn = true;
  return step;
}

Timeline::Look Timeline::look(const Frame& frame) const noexcept {
  Look now;
  now.digest = RecentFrames::digest_of(frame.values);
  now.counted = frame.counts && modulus_ > 0;
  now.clocked = frame.clocked && last_.clocked;
  if (now.counted) now.ahead = (frame.sequence % modulus_ + modulus_ - last_.sequence % modulus_) % modulus_;
  // Arrival times are invalid if samples are read much faster than measured, e.g. from a file.
  now.timed = frame.arrival_ns > 0 && due_ns_ > 0 && pace_.arrivals_tell();
  if (now.timed) look_at_arrival(frame, now);
  if (now.counted) now.counted_samples = rolled_over(now, frame.reopened);
  now.time_ns = frame.stamp_ns;
  if (now.clocked) look_at_clock(frame, now);
  return now;
}

void Timeline::look_at_arrival(const Frame& frame, Look& now) const noexcept {
  const double period_s = pace_.known() ? pace_.period_s() : 0.0;
  now.elapsed_s = seconds(ns_between(due_ns_, frame.arrival_ns));
  now.quiet_s = seen_ns_ > 0 ? seconds(ns_between(seen_ns_, frame.arrival_ns)) : now.elapsed_s;
  // Deliveries of many samples are usual where neither counter nor clock tells what a silence was.
  const double usual_s = now.tells() ? 0.0 : 1.5 * stall_s_;
  now.silent = now.quiet_s > std::max(kSilence_s, usual_s) + 2.0 * period_s;
  // The first of many samples in one read was delayed by the time of those after it.
  if (now.silent && frame.at_once > 1 && now.counted) now.elapsed_s -= (frame.at_once - 1.0) * period_s;
  now.slack_s = slack_s(now.elapsed_s);
}

// Samples by the counter, after a silence with the number of rollovers nearest to the elapsed time. Other
// lateness may be a delay.
std::uint64_t Timeline::rolled_over(const Look& now, bool reopened) const noexcept {
  double rounds = reopened && !now.timed && now.ahead == 0 ? 1.0 : 0.0;
  if (now.timed && (reopened || (now.silent && now.ahead != 1)))
    rounds = std::round((now.elapsed_s - pace_.time_s(now.ahead)) / pace_.time_s(modulus_));
  const auto more = static_cast<std::uint64_t>(std::clamp(rounds, 0.0, 1e12)) * modulus_;
  return std::max<std::uint64_t>(now.ahead + more, 1);
}

// Unwrapped stamp (KVH 1750 after 71 minutes, DBC signals after one): nearest to the elapsed time after a
// silence or without a counter, otherwise to the counter.
void Timeline::look_at_clock(const Frame& frame, Look& now) const noexcept {
  std::int64_t step_ns = ns_between(last_.stamp_ns, frame.stamp_ns);
  if (frame.wrap_ns > 0) {
    const double wrap_s = seconds(frame.wrap_ns);
    step_ns = (step_ns % frame.wrap_ns + frame.wrap_ns) % frame.wrap_ns;
    double near_s = pace_.known() ? pace_.nominal_s() : 0.0;
    if (now.silent || (!now.counted && now.timed))
      near_s = now.elapsed_s;
    else if (now.counted && now.ahead <= modulus_ / 2)
      near_s = pace_.time_s(now.counted_samples);
    const double rounds = std::clamp(std::round((near_s - seconds(step_ns)) / wrap_s), -1.0, 9e9 / wrap_s);
    step_ns = ns_after(step_ns, static_cast<std::int64_t>(rounds) * frame.wrap_ns);
  }
  now.passed_s = seconds(step_ns);
  now.time_ns = ns_after(last_.time_ns, step_ns);
}

bool Timeline::Look::contradicts(double claimed_s) const noexcept {
  return timed && claimed_s > elapsed_s + slack_s + kClocksApart * claimed_s;
}

// A duplicate, or overtaken: counter or clock goes back slightly without a silence.
bool Timeline::out_of_turn(const Frame& frame, const Look& now) const noexcept {
  if (now.silent) return false;
  const bool again = now.digest == last_.digest && now.passed_s == 0.0;
  if (!now.counted) {
    const bool goes_back = pace_.known() && now.passed_s < 0.0 &&
                           -now.passed_s <= static_cast<double>(RecentFrames::kMost) * pace_.nominal_s();
    return now.clocked && (again ? !ticks_.has_room() : goes_back);
  }
  if (now.ahead <= 1) return now.ahead == 0 && again;
  const std::uint64_t back = modulus_ - now.ahead, most = std::min(recent_.size(), modulus_ / 2);
  if (back > most || now.passed_s > 0.0 || (frame.reopened && !now.timed)) return false;
  // Frames of a coarse sensor at rest are equal, and none of them comes as late as the next after a loss.
  const Had was = recent_.had(back, now.digest);
  return was == Had::no || (was == Had::same && now.quiet_s < 0.5 * pace_.time_s(now.ahead));
}

// Restart after the elapsed time, also if that is unknown.
void Timeline::restart(const Look& now, Step& step) const noexcept {
  step.restarted = step.gap = true;
  step.dt_s = std::max(now.elapsed_s, pace_.nominal_s());
  step.samples = pace_.samples_in(step.dt_s);
}

bool Timeline::clock_is_wrong(const Look& now) const noexcept {
  const double grain_s = ticks_.grain_s();
  const double counted_s = pace_.time_s(now.counted_samples);
  if (now.passed_s < 0.0) return true;
  // A clock that agrees with the counter is right whenever the frame arrives. Otherwise the one nearer to the
  // elapsed time is.
  const double apart_s = 2.0 * pace_.nominal_s() + kClocksApart * now.passed_s + grain_s;
  if (now.counted && std::abs(now.passed_s - counted_s) <= apart_s) return false;
  if (now.contradicts(now.passed_s - grain_s)) return true;
  if (!now.counted) return false;
  if (!now.timed) return now.ahead == 1 && now.passed_s > counted_s + kNoSetting_s;
  return std::abs(counted_s - now.elapsed_s) < std::abs(now.passed_s - now.elapsed_s);
}

// With rollovers from the clock. If the counter stood or restarted, the clock alone is used.
std::uint64_t Timeline::samples_by_clock(const Look& now) const noexcept {
  const double grain_s = ticks_.grain_s(), usual_s = pace_.period_s();
  const double spare = now.passed_s / usual_s - static_cast<double>(now.ahead);
  double samples = std::max(1.0, static_cast<double>(now.ahead));
  if (spare > 2.0 + grain_s / usual_s)
    samples += static_cast<double>(modulus_) * std::round(spare / static_cast<double>(modulus_));
  const double took_s = now.passed_s / samples;
  const bool stood = took_s > kStoodStill * usual_s + grain_s && took_s > 2.0 * each_s_ && each_s_ > 0.0;
  const bool beyond =
      samples > 2.0 && samples * usual_s > 1.5 * now.passed_s + 2.0 * pace_.nominal_s() + grain_s;
  return stood || beyond ? SamplePace::at_least_one(now.passed_s / usual_s)
                         : SamplePace::at_least_one(samples);
}

// False: there is no clock, or it is invalid here.
bool Timeline::by_clock(const Frame& frame, const Look& now, Step& step) noexcept {
  if (!now.clocked) return false;
  if (!clock_is_wrong(now)) {
    step.dt_s = now.passed_s;
    if (!now.counted && !pace_.known()) return true;
    const Ticks::Step by_ticks =
        ticks_.take(nanoseconds(now.passed_s), now.counted ? samples_by_clock(now) : 0);
    step.samples = by_ticks.samples;
    step.dt_s = by_ticks.dt_s;
    step.ambiguous = step.samples > 1 && !now.timed && (!now.counted || step.samples > modulus_);
    return true;
  }
  if (now.silent || frame.reopened || (now.counted && now.ahead != 1) ||
      (!now.counted && (!now.timed || !pace_.known()))) {
    restart(now, step);
    step.time_ns = frame.stamp_ns;
    return true;
  }
  step.by_count = true;
  step.clock_set = ticks_.known();
  step.dt_s = pace_.nominal_s();
  return !now.counted;
}

void Timeline::by_counter(const Frame& frame, const Look& now, Step& step) const noexcept {
  step.samples = now.counted_samples;
  const double claimed_s = pace_.time_s(step.samples);
  const bool never_timed = due_ns_ == 0 && now.ahead > modulus_ / 2;
  const bool short_of = now.silent && claimed_s < now.elapsed_s - now.slack_s - kPrompt_s;
  const bool wrong = step.samples > 1 && (never_timed || short_of || now.contradicts(claimed_s));
  step.dt_s = static_cast<double>(step.samples) * pace_.nominal_s();
  if (wrong) {
    // Devices do not restart without a silence: one damaged counter is ignored, a few consecutive ones are
    // not.
    step.out_of_turn = !now.silent && !never_timed && !frame.reopened && strays_ < kStrays;
    restart(now, step);
  }
}

// For a device with neither, or whose clock starts. After a long silence a frame that is read alone is prompt;
// otherwise the interval is the advance of the due times, smoothed over a few samples.
void Timeline::by_elapsed(const Frame& frame, const Look& now, Step& step) noexcept {
  step.dt_s = std::max(0.0, now.elapsed_s);
  if (!pace_.known()) return;
  if (now.silent && (frame.reopened || (alone(frame) && now.quiet_s > kLatest_s))) {
    step.samples = pace_.samples_in(now.elapsed_s);
    return;
  }
  const double more_s = std::clamp(owed_s_, -0.25 * pace_.period_s(), 0.25 * pace_.period_s());
  step.dt_s = pace_.period_s() + more_s;
  owed_s_ -= more_s;
}

// Updates due times and delays from an accepted frame's arrival.
void Timeline::settle(const Frame& frame, const Look& now, Step& step) noexcept {
  const bool by_time = (now.clocked && !step.by_count) || step.restarted || !pace_.known();
  const double due_s = by_time ? step.dt_s : pace_.time_s(step.samples);
  if (due_ns_ > 0) due_ns_ = ns_after(due_ns_, nanoseconds(due_s));
  if (step.restarted) delay_.reset();
  if (frame.arrival_ns > 0) meet_arrival(frame, now, step);
  step.gap = step.gap || step.samples > 1;
  learn(frame, now, step);
  if (step.restarted) {
    recent_.forget();
    ticks_.jumped();
  }
  keep(frame, step.time_ns, step.samples, now.digest);
}

void Timeline::meet_arrival(const Frame& frame, const Look& now, Step& step) noexcept {
  const double late_s = seconds(ns_between(due_ns_, frame.arrival_ns));
  if (now.timed && !step.restarted) judge_delay(frame, now, late_s, step);
  if (!now.timed || step.restarted) due_ns_ = frame.arrival_ns;
  follow(seconds(ns_between(due_ns_, frame.arrival_ns)), frame.arrival_ns);
  if (delay_) step.late_s = std::max(0.0, late_s);
}

// A late frame counts as delayed until the delay drains or persists.
void Timeline::judge_delay(const Frame& frame, const Look& now, double late_s, Step& step) noexcept {
  const bool shown = now.counted && now.ahead != 1;
  if (now.silent && late_s > kSilence_s + scatter_s_) delay_ = {shown, late_s, late_s, frame.arrival_ns};
  if (!delay_) return;
  if (late_s < kPrompt_s + scatter_s_) {
    stall_s_ = std::clamp(delay_->most_late_s, stall_s_, kLatest_s);
    return delay_.reset();
  }
  if (late_s < delay_->least_late_s - kShrinks_s)
    *delay_ = {delay_->shown, delay_->most_late_s, late_s, frame.arrival_ns};
  if (seconds(ns_between(delay_->least_ns, frame.arrival_ns)) >= kStands_s)
    end_delay(frame, now, late_s, step);
}

// The delay persists: the silence was a gap, or deliveries take longer from now on.
void Timeline::end_delay(const Frame& frame, const Look& now, double late_s, Step& step) noexcept {
  const double round_s = now.counted ? pace_.time_s(modulus_) : late_s;
  const double slack = slack_s(late_s), lost = std::round(late_s / round_s);
  const bool whole = now.counted && lost >= 1.0 && std::abs(lost * round_s - late_s) <= slack;
  const double usual_s = now.clocked ? kLatest_s : now.counted ? std::min(round_s - slack, kLatest_s) : 0.0;
  // Stamps of a log are of a wall clock, which was set if the device's counter continues.
  const bool set = frame.recorded && now.tells() && !delay_->shown;
  delay_.reset();
  due_ns_ = frame.arrival_ns;
  step.clock_moved = late_s <= usual_s || set || !pace_.known();
  if (step.clock_moved) return;
  const std::uint64_t missing =
      whole ? static_cast<std::uint64_t>(lost) * modulus_ : pace_.samples_in(late_s);
  step.samples += missing;
  step.dt_s += whole ? static_cast<double>(missing) * pace_.nominal_s() : late_s;
  step.by_count = now.clocked;
}

// Frames do not arrive before they were measured: the due times follow the earliest arrivals, and slowly
// later ones, because crystals differ.
void Timeline::follow(double late_s, std::int64_t arrival_ns) noexcept {
  constexpr double kFollows = 1.0 / 256.0, kForgets = 1.0 - 1.0 / 1024.0;
  stall_s_ *= kForgets;
  if (late_s < -(kPrompt_s + scatter_s_) && ++early_ < kEarly) return;
  if (late_s < 0.0) {
    owed_s_ = early_ >= kEarly ? 0.0 : owed_s_ + late_s;
    due_ns_ = arrival_ns;
  } else if (!delay_) {
    scatter_s_ = std::max(kForgets * scatter_s_, std::min(late_s, kSilence_s));
    stall_s_ = std::max(stall_s_, std::min(late_s, kLatest_s));
    due_ns_ = ns_after(due_ns_, nanoseconds(kFollows * late_s));
    owed_s_ += kFollows * late_s;
  }
  if (!pace_.measured()) owed_s_ = 0.0;  // the line may have begun with a late sample; no interval is by it
  early_ = 0;
}

void Timeline::learn(const Frame& frame, const Look& now, const Step& step) noexcept {
  if (now.clocked && !step.by_count && !step.restarted)
    each_s_ = step.dt_s / static_cast<double>(std::max<std::uint64_t>(now.ahead, 1));
  const bool late = now.silent || delay_;
  if (frame.arrival_ns <= 0 || seen_ns_ <= 0 || step.gap || (late && now.tells())) return pace_.interrupted();
  const double since_s = seconds(ns_between(seen_ns_, frame.arrival_ns));
  pace_.learn(since_s, step.dt_s, step.samples, now.timed && !late);
}

void Timeline::keep(const Frame& frame, std::int64_t time_ns, std::uint64_t samples,
                    std::uint64_t digest) noexcept {
  recent_.keep(samples, digest);
  last_ = {frame.sequence, frame.clocked, frame.stamp_ns, time_ns, digest};
  if (frame.arrival_ns > 0) seen_ns_ = frame.arrival_ns;
}

}  // namespace ifog
