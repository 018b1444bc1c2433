// SPDX-License-Identifier: Apache-2.0
#include "filters/chain/incrementer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "drivers/ifog/turn.h"

namespace ifog {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kClockMemory_s = 20.0;
constexpr std::uint64_t kGapsThatShow = 64;
constexpr double kGapsAreNone = 5.0;  // s of samples that all come behind one
constexpr double kSetBack_s = 1.0;    // of the times of arrival: more than any order of delivery

int clock_memory(double rate_hz) {
  return static_cast<int>(std::clamp(kClockMemory_s * rate_hz, 64.0, 100000.0));
}

}  // namespace

Incrementer::Incrementer(const SensorFacts& facts) noexcept
    : facts_(facts),
      period_s_(1.0 / facts.nominal_rate_hz),
      clock_(period_s_, clock_memory(facts.nominal_rate_hz)),
      timeline_(facts.sequence_modulus, facts.nominal_rate_hz, facts.on_bus) {
  for (std::size_t axis = 0; axis < kMaxAxes; ++axis)
    rate_[axis] = PlausibleRate(facts.rate, facts.full_scale_radps[axis]);
  for (std::size_t c = 0; c < kMaxChannels; ++c)
    frame_channel_[c] = PlausibleValue(facts.channel[c], kMostChannel);
  channel_.fill(kNaN);
  channel_age_s_.fill(std::numeric_limits<float>::infinity());
}

double Incrementer::clock_offset_ppm() const noexcept {
  const double longer = clocked_samples_ > 0.0 ? clocked_periods_ / clocked_samples_ : 1.0;
  return clock_.settled() ? (clock_.period_s() / period_s_ * longer - 1.0) * 1e6 : 0.0;
}

double Incrementer::interval_error() const noexcept {
  if (row_s_ >= kGapsAreNone && gaps_in_a_row_ >= kGapsThatShow)
    return row_s_ / static_cast<double>(gaps_in_a_row_) / period_s_ - 1.0;
  const bool nominal = facts_.sequence_modulus > 0 && !last_.clocked;
  return nominal && clock_.settled() ? clock_.period_s() / period_s_ - 1.0 : 0.0;
}

// Whole rounds were lost where a silence was, as this sample tells.
bool Incrementer::rounds_told(const Step& step) const noexcept {
  return step.same_gap || (undecided_ && step.samples >= facts_.sequence_modulus);
}

DeviceTimeline::Frame Incrementer::frame_of(const Reading& reading) const noexcept {
  DeviceTimeline::Frame frame;
  frame.counts = reading.has_sequence;
  frame.sequence = reading.sequence;
  frame.clocked = reading.device_time_ns.has_value();
  frame.stamp = {reading.device_time_ns.value_or(0), reading.device_wrap_ns};
  // Half of what a signed stamp goes through is below 0: of its rounds those from there on are published.
  if (frame.stamp.ns < 0 && frame.stamp.wrap_ns > 0) frame.stamp.ns += frame.stamp.wrap_ns;
  frame.arrival_ns = reading.arrival_ns;
  frame.reopened = reopened_;
  frame.values = {reading.value.data(), static_cast<std::size_t>(facts_.axes)};
  return frame;
}

Incrementer::Step Incrementer::step_by_arrival(const Reading& reading) noexcept {
  Step step;
  const double elapsed_s = arrivals_.elapsed_s(reading.arrival_ns);
  const double period_s = clock_.period_s();
  const double late_s = clock_.lateness_s(1, reading.arrival_ns);
  const Silence::Next next{elapsed_s, late_s, reading.at_once};
  Silence::Ends ends = Silence::Ends::none;
  if (elapsed_s > 0.0 && reopened_)
    step.samples = at_least_one(elapsed_s / period_s);
  else
    ends = silence_.look(next, period_s);
  if (ends == Silence::Ends::hole) step.samples = at_least_one(late_s / period_s + 1.0);
  if (ends == Silence::Ends::hold_up) step.late_s = late_s;
  silence_.take(next, ends);
  step.gap = step.samples > 1;
  step.dt_s = static_cast<double>(step.samples) * period_s;
  return step;
}

Incrementer::Step Incrementer::step(const Reading& reading, const DeviceTimeline::Frame& frame) noexcept {
  if (timeline_.tells(frame)) return timeline_.next(frame);
  Step step = step_by_arrival(reading);
  step.gap = step.gap || reopened_;
  step.time_ns = timeline_.first(frame);
  return step;
}

Verdict Incrementer::turn_of_angle(std::size_t axis, double value, Turn& out) noexcept {
  PlausibleAngle& angle = angle_[axis];
  OpenTurn& open = open_turn_[axis];
  if (silence_begins_s_ > 0.0) {
    const std::optional<Turn> turned = angle.proposed(value, facts_.angle_wrap_rad);
    if (turned && hides_more(turned->angle_rad / turned->covered_s, angle.rate_radps())) {
      const bool known = angle.take_unjudged(value, facts_.angle_wrap_rad, silence_begins_s_);
      open.begin(*turned, silence_begins_s_, known);
      out = {};
      return Verdict::plausible;
    }
  }
  Verdict verdict = angle.take(value, facts_.angle_wrap_rad, rate_[axis], out);
  if (verdict == Verdict::plausible && out.covered_s > 0.0 && open.open() && !undecided_) {
    mean_radps_[axis] = open.close(out);
    verdict = rate_[axis].take(*mean_radps_[axis]);
  }
  return verdict;
}

Verdict Incrementer::turn(std::size_t axis, double value, double own_s, Turn& out) noexcept {
  switch (facts_.kind) {
    case SensorKind::angle:
      return turn_of_angle(axis, value, out);
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
  const double own_s = step.dt_s / static_cast<double>(step.samples);  // a gap's time is not this sample's
  out.valid_axes = out.stuck_axes = 0;
  bool invalid = false, unseen = false, saturated = false, implausible = false;
  if (const std::uint32_t seen = axes_seen_ | reading.valid_axes; seen != std::exchange(axes_seen_, seen))
    counts_.invalid += std::exchange(without_unseen_, 0);
  for (int i = 0; i < facts_.axes; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    // What is found to be missing where a silence was is no time of this sample's turn.
    const double belated_s = belated_ ? step.dt_s - own_s : 0.0;
    angle_[axis].pass(step.dt_s - belated_s);
    open_turn_[axis].lost(belated_s);
    if (silence_ends_) open_turn_[axis].rest_was(step.clock_moved);
    mean_radps_[axis].reset();
    Turn turned;
    if (((reading.valid_axes >> i) & 1u) == 0) {
      const bool known = axes_seen_ == 0 || ((axes_seen_ >> i) & 1u) != 0;
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
    // A rate is passed on as sent: dividing the product again would cost its last bit.
    if (turned.covered_s > 0.0) {
      out.rate_radps[axis] = facts_.kind == SensorKind::rate
                                 ? reading.value[axis]
                                 : mean_radps_[axis].value_or(turned.angle_rad / turned.covered_s);
      out.valid_axes |= 1u << i;
      if (check_.stuck(axis, reading.value[axis])) out.stuck_axes |= 1u << i;
    } else {
      out.rate_radps[axis] = kNaN;
    }
  }
  if (invalid || unseen) out.flags |= kInvalid;
  if (saturated) out.flags |= kAtFullScale;
  counts_.invalid += invalid ? 1 : 0;
  without_unseen_ += unseen && !invalid ? 1 : 0;
  counts_.saturated += saturated ? 1 : 0;
  counts_.implausible += implausible ? 1 : 0;
}

void Incrementer::hold_channels(const Reading& reading, std::uint64_t samples, Increment& out) noexcept {
  for (int i = 0; i < facts_.channels; ++i) {
    const auto c = static_cast<std::size_t>(i);
    if (i >= facts_.frame_channels) {
      channel_[c] = reading.channel[c];
      channel_age_s_[c] = reading.channel_age_s[c];
      continue;
    }
    const bool fresh = ((reading.fresh_channels >> i) & 1u) != 0;
    if (fresh && frame_channel_[c].take(reading.channel[c])) {
      channel_[c] = reading.channel[c];
      channel_age_s_[c] = 0.0F;
    } else {
      if (fresh) ++counts_.channel_implausible;
      channel_age_s_[c] += static_cast<float>(out.dt_s);
    }
  }
  // As with a rate: a gap's time is not this sample's, and a value that is held is none that was measured.
  const double own_s = out.dt_s / static_cast<double>(samples);
  for (std::size_t axis = 0; axis < kMaxAxes; ++axis) {
    const int c = facts_.acceleration_channel[axis];
    const bool measured = c >= 0 && channel_age_s_[static_cast<std::size_t>(c)] == 0.0F;
    out.delta_v_mps[axis] = measured ? channel_[static_cast<std::size_t>(c)] * own_s : 0.0;
    out.moved_s[axis] = measured ? own_s : 0.0;
  }
  out.channel = channel_;
  out.channel_age_s = channel_age_s_;
}

// That have passed, in nominal ones: a device's own clock says it whatever rate the device was set to.
double Incrementer::periods_of(const Step& step, bool clocked) noexcept {
  constexpr double kForgets = 0.999;
  const auto samples = static_cast<double>(step.samples);
  if (!clocked) return samples;
  const double periods = step.dt_s / period_s_;
  if (!step.gap) {
    clocked_periods_ = kForgets * clocked_periods_ + periods;
    clocked_samples_ = kForgets * clocked_samples_ + samples;
  }
  return periods;
}

// When the sample was taken, by a line through the times of arrival.
void Incrementer::label(const Reading& reading, const Step& step, Increment& out) noexcept {
  using Says = LabelLateness::Says;
  // A clock that was set back says nothing of what has passed.
  const bool set_back = reading.arrival_ns > 0 &&
                        static_cast<double>(arrivals_.latest_ns() - reading.arrival_ns) * 1e-9 > kSetBack_s;
  const double periods = periods_of(step, reading.device_time_ns.has_value());
  Says says = Says::follow;
  if (reading.arrival_ns > 0 && step.late_s == 0.0 && !step.clock_moved && !set_back)
    says = label_lateness_.next(clock_.lateness_s(periods, reading.arrival_ns), clock_.spread_s(),
                                arrivals_.elapsed_s(reading.arrival_ns));
  else if (reading.arrival_ns > 0)
    label_lateness_.forget();
  const bool stood = step.clock_moved || says == Says::stood;
  const bool moved = started_ && (stood || set_back);
  if (stood || set_back || says == Says::ahead) clock_.restart();
  // Of recorded times nobody knows whether the clock was set or the device did not count on; by one that
  // nobody sets it was the device.
  if (started_ &&
      (reading.wall_shift_ns != last_.wall_shift_ns || set_back || (moved && reading.arrival_recorded))) {
    out.flags |= kClockStep;
    ++counts_.clock_steps;
  } else if (moved) {
    ++counts_.pauses;
  }
  // What is held up on its way says nothing of the clock, but for where a clock that was set has to begin.
  const bool held_up = (step.late_s > 0.0 || says == Says::wait) && !set_back;
  out.utime_ns = ns_after(clock_.advance(periods, held_up ? 0 : reading.arrival_ns), reading.wall_shift_ns);
  // Later than the one before also in the message's microseconds: a line that has few samples yet goes to and
  // fro by as much as arrival times scatter.
  if (started_ && (out.flags & kClockStep) == 0)
    out.utime_ns = std::max(out.utime_ns, ns_after(last_.utime_ns, 1000));
}

void Incrementer::pass_gap(const Step& now, Increment& out) noexcept {
  out.flags |= kGapBefore;
  for (PlausibleRate& rate : rate_) rate.forget();
  if (!belated_)
    for (PlausibleAngle& angle : angle_) angle.miss();
  for (PlausibleValue& channel : frame_channel_) channel.forget();
  counts_.gaps += now.same_gap ? 0 : 1;
  counts_.missing += now.samples - 1;
  counts_.untold += now.untold ? now.samples - 1 : 0;
  clock_.restart();
}

// An angle counts from power-up: after a restart it says nothing about the turn since the last one.
void Incrementer::begin_anew() noexcept {
  ++counts_.restarts;
  for (PlausibleAngle& angle : angle_) angle.forget();
  for (OpenTurn& open : open_turn_) open.forget();
}

bool Incrementer::next(const Reading& reading, Increment& out) noexcept {
  const DeviceTimeline::Frame frame = frame_of(reading);
  Step now;
  if (started_) {
    now = step(reading, frame);
    if (now.out_of_turn) {
      ++counts_.repeated;
      counts_.mixed += timeline_.mixed() ? 1 : 0;
      return false;
    }
    sequence_ += now.samples;
  } else {
    now.dt_s = period_s_;
    sequence_ = reading.has_sequence ? reading.sequence : 0;
    now.time_ns = timeline_.first(frame);
  }
  belated_ = rounds_told(now);
  out.flags = 0;
  if (started_ && now.gap) pass_gap(now, out);
  if (now.restarted) begin_anew();
  const bool in_a_row = now.gap && !now.restarted && frame.clocked && !frame.counts;
  gaps_in_a_row_ = in_a_row ? gaps_in_a_row_ + 1 : 0;
  row_s_ = in_a_row ? row_s_ + now.dt_s : 0.0;
  if (now.clock_set) {
    out.flags |= kSensorClockSet;
    ++counts_.sensor_clock_sets;
  }
  silence_begins_s_ = now.undecided && !undecided_ ? now.late_s : 0.0;
  silence_ends_ = undecided_ && !now.undecided;
  undecided_ = now.undecided;
  out.samples = 1;
  out.status = reading.status;
  out.sequence = sequence_;
  out.arrival_ns = reading.arrival_ns;
  out.came_ns = reading.came_ns;
  out.wall_shift_ns = reading.wall_shift_ns;
  out.device_time_ns = frame.clocked ? now.time_ns : -1;
  out.dt_s = now.dt_s;
  label(reading, now, out);
  arrivals_.came(reading.arrival_ns, now.dt_s);
  measure(reading, now, out);
  hold_channels(reading, now.samples, out);
  ++counts_.samples;
  last_ = {reading.wall_shift_ns, out.utime_ns, frame.clocked};
  started_ = true;
  reopened_ = false;
  return true;
}

}  // namespace ifog
