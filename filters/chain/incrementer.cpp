// SPDX-License-Identifier: Apache-2.0
#include "filters/chain/incrementer.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include "drivers/system/nanoseconds.h"

namespace ifog {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kClockMemory_s = 20.0;
constexpr double kAccelerated = -0.95;  // samples from a recording, not at its pace
constexpr double kLate_s = 0.25;        // delay of a delivery that is no silence
constexpr double kRight = 0.01;         // relative; no quartz has a larger error
constexpr int kEarly = 8;               // consecutive arrivals; a single wrong stamp does not count
constexpr double kApart_s = 0.1;        // distance from the line of labels; less is scheduling
constexpr double kScatters = 4.0;       // times the mean distance
constexpr double kStands_s = 1.0;       // a delayed delivery is over within this time

int clock_memory(double rate_hz) {
  return static_cast<int>(std::clamp(kClockMemory_s * rate_hz, 64.0, 100000.0));
}

}  // namespace

Incrementer::Incrementer(const SensorFacts& facts) noexcept
    : facts_(facts),
      period_s_(1.0 / facts.nominal_rate_hz),
      labels_{.clock = {period_s_, clock_memory(facts.nominal_rate_hz)}},
      timeline_(facts.sequence_modulus, facts.nominal_rate_hz) {
  for (std::size_t axis = 0; axis < kMaxAxes; ++axis)
    rate_[axis] = PlausibleRate(facts.rate, facts.full_scale_radps[axis]);
  for (std::size_t c = 0; c < kMaxChannels; ++c)
    channels_.plausible[c] = PlausibleValue(facts.channel[c], kMostChannel);
  channels_.value.fill(kNaN);
  channels_.age_s.fill(std::numeric_limits<float>::infinity());
}

double Incrementer::clock_offset_ppm() const noexcept {
  const double longer =
      labels_.clocked_samples > 0.0 ? labels_.clocked_periods / labels_.clocked_samples : 1.0;
  return labels_.clock.settled() ? (labels_.clock.period_s() / period_s_ * longer - 1.0) * 1e6 : 0.0;
}

// Measures the rate of samples by their arrivals, at both ends of the stretch late by up to kLate_s.
void Incrementer::look_at_rate(const Timeline::Frame& frame, const Step& now) noexcept {
  if (frame.arrival_ns <= 0) return;
  const double lasts_s =
      static_cast<double>(ns_between(stretch_.begin_ns, frame.arrival_ns)) * 1e-9 * facts_.speed;
  if (stretch_.begin_ns == 0 || now.restarted || now.clock_moved || frame.reopened ||
      lasts_s > kClockMemory_s) {
    stretch_ = {.begin_ns = frame.arrival_ns,
                .begin_clock_ns = now.time_ns,
                .interval_error = stretch_.interval_error};
    return;
  }
  ++stretch_.frames;
  stretch_.gaps += now.gap ? 1 : 0;
  stretch_.samples += now.samples;
  stretch_.by_count += now.by_count ? 1 : 0;
  stretch_.sum_s += now.dt_s;
  if (lasts_s < 0.25 * kClockMemory_s) return;
  if (frame.clocked) look_at_clock(now, lasts_s);
  // If nearly each frame seems to come after a gap, there are none.
  const bool no_gaps = 10 * stretch_.gaps > 9 * stretch_.frames;
  if (!no_gaps && (!frame.counts || frame.clocked)) return;
  const auto samples = static_cast<double>(no_gaps ? stretch_.frames : stretch_.samples);
  const double error = lasts_s / (samples * period_s_) - 1.0;
  if (std::abs(error) < kRight || error < kAccelerated)
    stretch_.interval_error = 0.0;
  else if (std::abs(error) > kRight + kLate_s * facts_.speed / lasts_s)
    stretch_.interval_error = error;
}

// Refuses a clock whose intervals differ from the arrivals while the number of frames at the nominal rate agrees
// with these far better, or that nearly no interval could use. Samples that are read late, or faster than they
// were measured, differ from both alike.
void Incrementer::look_at_clock(const Step& now, double lasts_s) noexcept {
  const double by_clock = stretch_.sum_s / lasts_s;
  const double by_rate = static_cast<double>(stretch_.frames) * period_s_ / lasts_s;
  const bool off = std::abs(by_clock - 1.0) > kRight + kLate_s * facts_.speed / lasts_s &&
                   std::abs(std::log(by_rate)) < 0.5 * std::abs(std::log(by_clock));
  if (!off && 10 * stretch_.by_count <= 9 * stretch_.frames) return;
  refused_clock_ = static_cast<double>(ns_between(stretch_.begin_clock_ns, now.time_ns)) * 1e-9 / lasts_s;
  timeline_ = Timeline(facts_.sequence_modulus, facts_.nominal_rate_hz);
  labels_ = {.clock = {period_s_, clock_memory(facts_.nominal_rate_hz)}};
  stretch_ = {};
  before_.timeline = false;
}

Timeline::Frame Incrementer::frame_of(const Reading& reading) const noexcept {
  Timeline::Frame frame;
  frame.counts = reading.has_sequence;
  frame.sequence = reading.sequence;
  frame.clocked = reading.device_time_ns.has_value() && !refused_clock_;
  frame.stamp_ns = reading.device_time_ns.value_or(0);
  frame.wrap_ns = reading.device_wrap_ns;
  // A signed negative stamp: published times start at the rollover before it.
  if (frame.stamp_ns < 0 && frame.wrap_ns > 0) frame.stamp_ns += frame.wrap_ns;
  frame.arrival_ns = reading.arrival_ns;
  frame.recorded = reading.arrival_recorded;
  frame.at_once = reading.at_once;
  frame.reopened = before_.reopened;
  frame.values = {reading.value.data(), static_cast<std::size_t>(facts_.axes)};
  return frame;
}

Verdict Incrementer::turn(std::size_t axis, double value, double own_s, Turn& out) noexcept {
  switch (facts_.kind) {
    case SensorKind::angle:
      return angle_[axis].take(value, facts_.angle_wrap_rad, rate_[axis], out);
    case SensorKind::delta_angle:
      out = {value, own_s};
      return rate_[axis].take(value / period_s_);
    case SensorKind::rate:
      break;
  }
  out = {value * own_s, own_s};
  return rate_[axis].take(value);
}

void Incrementer::measure(const Reading& reading, const Step& step, Increment& out) noexcept {
  const double own_s = step.dt_s / static_cast<double>(step.samples);  // without the time of a gap
  out.valid_axes = out.stuck_axes = 0;
  bool invalid = false, unseen = false, saturated = false, implausible = false;
  if (const std::uint32_t seen = seen_.axes | reading.valid_axes; seen != std::exchange(seen_.axes, seen))
    counts_.invalid += std::exchange(seen_.without_others, 0);
  for (int i = 0; i < facts_.axes; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    angle_[axis].pass(step.dt_s);
    Turn turned;
    if (((reading.valid_axes >> i) & 1u) == 0) {
      const bool known = seen_.axes == 0 || ((seen_.axes >> i) & 1u) != 0;
      (known ? invalid : unseen) = true;
    } else if (const Verdict verdict = turn(axis, reading.value[axis], own_s, turned);
               verdict != Verdict::plausible) {
      turned = {};
      invalid = true;
      saturated = saturated || verdict == Verdict::saturated;
      implausible = implausible || verdict == Verdict::implausible;
    }
    out.delta_theta_rad[axis] = turned.angle_rad;
    out.covered_s[axis] = turned.covered_s;
    // A rate is used as sent; dividing the product would lose its last bit.
    if (turned.covered_s > 0.0) {
      out.rate_radps[axis] =
          facts_.kind == SensorKind::rate ? reading.value[axis] : turned.angle_rad / turned.covered_s;
      out.valid_axes |= 1u << i;
      if (check_.stuck(axis, reading.value[axis])) out.stuck_axes |= 1u << i;
    } else {
      out.rate_radps[axis] = kNaN;
    }
  }
  if (invalid) out.flags |= kInvalid;  // an axis that has never been valid is absent
  if (saturated) out.flags |= kAtFullScale;
  counts_.invalid += invalid ? 1 : 0;
  seen_.without_others += unseen && !invalid ? 1 : 0;
  counts_.saturated += saturated ? 1 : 0;
  counts_.implausible += implausible ? 1 : 0;
}

void Incrementer::hold_channels(const Reading& reading, std::uint64_t samples, Increment& out) noexcept {
  for (int i = 0; i < facts_.channels; ++i) {
    const auto c = static_cast<std::size_t>(i);
    if (i >= facts_.frame_channels) {
      channels_.value[c] = reading.channel[c];
      channels_.age_s[c] = reading.channel_age_s[c];
      continue;
    }
    const bool fresh = ((reading.fresh_channels >> i) & 1u) != 0;
    if (fresh && channels_.plausible[c].take(reading.channel[c])) {
      channels_.value[c] = reading.channel[c];
      channels_.age_s[c] = 0.0F;
    } else {
      if (fresh) ++counts_.channel_implausible;
      channels_.age_s[c] += static_cast<float>(out.dt_s);
    }
  }
  // As for a rate: without the time of a gap; a held value is no measurement.
  const double own_s = out.dt_s / static_cast<double>(samples);
  for (std::size_t axis = 0; axis < kMaxAxes; ++axis) {
    const int c = facts_.acceleration_channel[axis];
    const bool measured = c >= 0 && channels_.age_s[static_cast<std::size_t>(c)] == 0.0F;
    out.delta_v_mps[axis] = measured ? channels_.value[static_cast<std::size_t>(c)] * own_s : 0.0;
    out.moved_s[axis] = measured ? own_s : 0.0;
  }
  out.channel = channels_.value;
  out.channel_age_s = channels_.age_s;
}

// Nominal periods since the last sample; the device's clock is valid at any configured rate.
double Incrementer::periods_of(const Step& step, bool clocked) noexcept {
  constexpr double kForgets = 0.999;
  const auto samples = static_cast<double>(step.samples);
  if (!clocked) return samples;
  const double periods = step.dt_s / period_s_;
  if (!step.gap) {
    labels_.clocked_periods = kForgets * labels_.clocked_periods + periods;
    labels_.clocked_samples = kForgets * labels_.clocked_samples + samples;
  }
  return periods;
}

// Slewing moves the wall clock by at most 1/12 of the time (chrony); the labels follow it.
bool Incrementer::wall_was_set(const Reading& reading) const noexcept {
  constexpr std::int64_t kSlews = 8, kLeast_ns = 1'000'000;
  const std::int64_t by_ns = std::abs(ns_between(last_.wall_shift_ns, reading.wall_shift_ns));
  const std::int64_t since_ns = std::max<std::int64_t>(0, ns_between(last_.read_ns, reading.read_ns));
  return by_ns > kLeast_ns + since_ns / kSlews;
}

// True if the line of labels must restart at this arrival: several arrivals are early, or arrivals stay late.
// A single early or late stamp has no effect.
bool Incrementer::apart(double late_s, std::int64_t arrival_ns) noexcept {
  const double usual_s = std::max(kApart_s, kScatters * labels_.clock.spread_s());
  labels_.early = late_s < -usual_s ? labels_.early + 1 : 0;
  if (late_s <= usual_s)
    labels_.late_since_ns = 0;
  else if (labels_.late_since_ns == 0)
    labels_.late_since_ns = arrival_ns;
  const bool stands = labels_.late_since_ns != 0 &&
                      static_cast<double>(ns_between(labels_.late_since_ns, arrival_ns)) > kStands_s * 1e9;
  return labels_.early >= kEarly || stands;
}

// Time of measurement, from a line through the arrival times.
void Incrementer::label(const Reading& reading, const Step& step, Increment& out) noexcept {
  const double periods = periods_of(step, reading.device_time_ns && !refused_clock_);
  bool moved = step.clock_moved;
  bool unlike = false;
  if (reading.arrival_ns > 0 && step.late_s == 0.0 && !step.gap) {
    moved = apart(labels_.clock.lateness_s(periods, reading.arrival_ns), reading.arrival_ns) || moved;
    unlike = labels_.early > 0 || labels_.late_since_ns != 0;
  }
  if (moved || step.gap) {
    labels_.early = 0;
    labels_.late_since_ns = 0;
  }
  moved = moved && before_.started;
  if (moved) labels_.clock.restart();
  // Stamps of a log are by a wall clock, which was set; with an unslewed clock the line moves.
  if (before_.started && (wall_was_set(reading) || (moved && reading.arrival_recorded))) {
    out.flags |= kClockStep;
    ++counts_.clock_steps;
  } else if (moved) {
    ++counts_.pauses;
  }
  const bool delayed = step.late_s > 0.0 || (unlike && !moved);
  out.utime_ns =
      ns_after(labels_.clock.advance(periods, delayed ? 0 : reading.arrival_ns), reading.wall_shift_ns);
  // Later than the last label by at least the message's 1 us: a young line moves by as much as arrivals
  // scatter.
  if (before_.started && (out.flags & kClockStep) == 0)
    out.utime_ns = std::max(out.utime_ns, ns_after(last_.utime_ns, 1000));
}

void Incrementer::pass_gap(const Step& now, Increment& out) noexcept {
  out.flags |= kGapBefore;
  for (PlausibleRate& rate : rate_) rate.forget();
  for (PlausibleAngle& angle : angle_) angle.miss();
  for (PlausibleValue& channel : channels_.plausible) channel.forget();
  ++counts_.gaps;
  counts_.missing += now.samples - 1;
  counts_.ambiguous += now.ambiguous ? now.samples - 1 : 0;
  labels_.clock.restart();
}

// An angle counts from power-up, so after a restart the turn since the last one is unknown.
void Incrementer::restart() noexcept {
  ++counts_.restarts;
  for (PlausibleAngle& angle : angle_) angle.forget();
}

bool Incrementer::next(const Reading& reading, Increment& out) noexcept {
  const Timeline::Frame frame = frame_of(reading);
  Step now;
  if (before_.timeline) {
    now = timeline_.next(frame);
    if (now.out_of_turn) {
      ++counts_.repeated;
      counts_.mixed += timeline_.two_devices() ? 1 : 0;
      return false;
    }
    sequence_ += now.samples;
  } else {
    now.dt_s = period_s_;
    now.gap = now.clock_set = before_.started;  // its clock has been refused
    sequence_ = before_.started ? sequence_ + 1 : reading.has_sequence ? reading.sequence : 0;
    now.time_ns = timeline_.first(frame);
  }
  out.flags = 0;
  if (now.gap) pass_gap(now, out);
  if (now.restarted) restart();
  before_.timeline = true;
  look_at_rate(frame, now);
  if (now.clock_set) {
    out.flags |= kSensorClockSet;
    ++counts_.sensor_clock_sets;
  }
  if (reading.beyond_stated) out.flags |= kBeyondStated;
  out.samples = 1;
  out.status = reading.status;
  out.sequence = sequence_;
  out.arrival_ns = reading.arrival_ns;
  out.read_ns = reading.read_ns;
  out.wall_shift_ns = reading.wall_shift_ns;
  out.device_time_ns = frame.clocked ? now.time_ns : -1;
  out.dt_s = now.dt_s;
  label(reading, now, out);
  measure(reading, now, out);
  hold_channels(reading, now.samples, out);
  ++counts_.samples;
  last_ = {reading.wall_shift_ns, out.utime_ns, reading.read_ns};
  before_.started = true;
  before_.reopened = false;
  return true;
}

}  // namespace ifog
