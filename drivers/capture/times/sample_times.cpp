// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/times/sample_times.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "drivers/host/timeline_frame.h"

namespace ifog {
namespace {

constexpr double kNsPerSecondExact = 1e9;  // division gives the double nearest to the decimal time

Timeline timeline_of(const ifog_description& description) {
  return {description.sequence_modulus, description.nominal_rate_hz};
}

// Wraps on overflow, which then looks like a clock jump.
std::int64_t ns_since(const TimeOrigin& origin, std::int64_t time_ns) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(time_ns) -
                                   static_cast<std::uint64_t>(origin.s) * 1'000'000'000U -
                                   static_cast<std::uint64_t>(origin.ns));
}

}  // namespace

SampleTimes::SampleTimes(const ifog_description& description)
    : description_(description), timeline_(timeline_of(description)) {}

void SampleTimes::go_on_as(const ifog_description& description) {
  description_ = description;
  timeline_ = timeline_of(description);
  clock_ = Clock::undecided;
  broken_ = true;
}

void SampleTimes::choose_clock(const ifog_sample& sample) {
  arrivals_.first_ns = sample.arrival_ns;
  const bool rate_known = description_.nominal_rate_hz > 0.0;
  if ((sample.flags & IFOG_SAMPLE_DEVICE_TIME) != 0) {
    clock_ = Clock::device;
    device_from_ = TimeOrigin::of(sample.device_time_ns);
  } else if ((sample.flags & IFOG_SAMPLE_SEQUENCE) != 0 && rate_known) {
    clock_ = Clock::counter;
  } else if (sample.arrival_ns != 0 || arrivals_.zero_of_stamps_ns) {
    clock_ = Clock::arrival;
  } else if (rate_known) {
    clock_ = Clock::number;
  } else {
    throw std::runtime_error(
        "the samples carry no time: expected the option rate_hz with the samples a second of the device");
  }
}

void SampleTimes::count_from(const ifog_sample& sample) {
  if (clock_ == Clock::device) {
    origin_ = device_from_;
  } else if (arrivals_.zero_of_stamps_ns) {
    const std::int64_t stamp_ns = sample.arrival_ns - *arrivals_.zero_of_stamps_ns;
    origin_ = TimeOrigin::of(stamp_ns);
    const std::int64_t since_ns = ns_since(origin_, stamp_ns);
    if (clock_ == Clock::arrival) {
      arrivals_.first_ns -= since_ns;
      return;
    }
    // In whole samples if possible, so that no time is a sum of two rounded ones.
    const double samples = static_cast<double>(since_ns) / kNsPerSecondExact * description_.nominal_rate_hz;
    if (samples >= 0.0 && std::abs(samples - std::round(samples)) < 1e-6)
      count_ = static_cast<std::uint64_t>(std::llround(samples));
    else
      offset_s_ = static_cast<double>(since_ns) / kNsPerSecondExact;
  }
}

Timeline::Frame SampleTimes::frame_of(const ifog_sample& sample) const {
  Timeline::Frame frame = timeline_frame(sample, description_.axes);
  frame.recorded = arrivals_.zero_of_stamps_ns.has_value();
  return frame;
}

double SampleTimes::seconds(const ifog_sample& sample) const {
  switch (clock_) {
    case Clock::device:
      return static_cast<double>(ns_since(device_from_, device_ns_)) / kNsPerSecondExact + offset_s_;
    case Clock::arrival:
      return static_cast<double>(sample.arrival_ns - arrivals_.first_ns) / kNsPerSecondExact + offset_s_;
    default:
      return static_cast<double>(count_) / description_.nominal_rate_hz + offset_s_;
  }
}

// Sets the offset of the sample's clock by its arrival time relative to the previous one.
void SampleTimes::begin_again(const ifog_sample& sample) {
  broken_ = false;
  const double later_s = static_cast<double>(sample.arrival_ns - arrivals_.last_ns) * 1e-9;
  const double rate_hz = description_.nominal_rate_hz;
  const double least_s = rate_hz > 0.0 ? 1.0 / rate_hz : 1e-6;
  const bool known = arrivals_.zero_of_stamps_ns || (sample.arrival_ns != 0 && arrivals_.last_ns != 0);
  offset_s_ += last_s_ + std::max(known ? later_s : 0.0, least_s) - seconds(sample);
}

// Time of the next sample of a device with neither counter nor clock, from arrivals. Samples of one delivery
// were measured one after the other. The first few samples show which case it is.
double SampleTimes::spread(const ifog_sample& sample, const Timeline::Step& step, double arrived_s) {
  constexpr double kFollows = 0.02;             // share of the distance to the arrival per sample
  constexpr double kLeast = 0.5, kMost = 1.25;  // periods between two samples
  constexpr double kEven = 0.85;                // smallest step if samples arrive as measured
  constexpr std::size_t kShows = 16;            // samples
  constexpr double kResolution_s = 1e-9;        // of arrival times
  const double period_s = 1.0 / description_.nominal_rate_hz;
  const double next_s = last_s_ + period_s, late_s = arrived_s - next_s;
  const double elapsed_s = static_cast<double>(sample.arrival_ns - arrivals_.last_ns) / kNsPerSecondExact;
  const bool delayed = step.late_s > 0.0;
  arrivals_.bunched = arrivals_.bunched || elapsed_s < kEven * period_s || sample.at_once > 1 || delayed;
  if (delayed) return next_s;
  if (step.gap || step.clock_moved || std::abs(late_s) < kResolution_s) return arrived_s;
  // Samples that arrive individually get their arrival time, without a jump where the first ones were late,
  // or early because the rate is higher than nominal.
  if (!arrivals_.bunched && accepted_ >= kShows)
    return std::clamp(arrived_s, last_s_ + elapsed_s / kMost,
                      last_s_ + kMost * std::max(period_s, elapsed_s));
  return last_s_ + std::clamp(period_s + kFollows * late_s, kLeast * period_s, kMost * period_s);
}

void SampleTimes::refuse(double now) const {
  std::string text = "sample " + std::to_string(accepted_ + 1) + ": its time is ";
  append_time(text, origin_, now);
  text += clock_ == Clock::device    ? " s by the device's clock"
          : clock_ == Clock::counter ? " s by its counter"
                                     : " s by its arrival";
  text += ", expected more than the ";
  append_time(text, origin_, last_s_);
  throw std::runtime_error(text + " s of the sample before");
}

std::optional<SampleTimes::Stamped> SampleTimes::next(const ifog_sample& sample) {
  const bool first = accepted_ == 0;
  if (clock_ == Clock::undecided) choose_clock(sample);
  if (first) count_from(sample);
  bool restarted = broken_ && !first;
  Timeline::Step step;
  if (first || restarted)
    step.time_ns = timeline_.first(frame_of(sample));
  else
    step = timeline_.next(frame_of(sample));
  if (step.out_of_turn) {
    ++(timeline_.two_devices() ? counts_.mixed : counts_.repeated);
    return std::nullopt;
  }
  const std::uint64_t steps = first || restarted ? 0 : step.samples;
  const bool clock_restarted =
      step.restarted && (restarts_ || clock_ != Clock::device || sample.device_wrap_ns > 0);
  count_ += steps;
  if (steps > 1) counts_.missing += steps - 1;
  if (steps > 1 && step.ambiguous) counts_.ambiguous += steps - 1;
  if (clock_restarted) ++counts_.restarts;
  device_ns_ = step.time_ns;
  restarted = restarted || (clock_restarted && clock_ == Clock::device);
  if (restarted) begin_again(sample);
  broken_ = false;
  if (step.clock_set) ++counts_.clock_sets;
  // If the device's clock stood still while it measured: the sum of its steps. If it was set while the device
  // continued to count: the counter.
  if (!first && !restarted && clock_ == Clock::device && (timeline_.clock_stood() || step.by_count))
    offset_s_ += last_s_ + step.dt_s - seconds(sample);
  double now = seconds(sample);
  const bool by_arrival =
      clock_ == Clock::arrival && !arrivals_.zero_of_stamps_ns && description_.nominal_rate_hz > 0.0;
  if (!first && !restarted && by_arrival && sample.arrival_ns >= arrivals_.last_ns)
    now = spread(sample, step, now);
  if (!first && now <= last_s_) {
    if (!restarts_) refuse(now);
    if (now == last_s_) {
      ++counts_.repeated;
      return std::nullopt;
    }
    restarted = true;
    begin_again(sample);
    now = seconds(sample);
  }
  Stamped stamped;
  stamped.since_s = now;
  stamped.elapsed_s = first ? std::numeric_limits<double>::quiet_NaN() : now - last_s_;
  stamped.restarted = restarted;
  stamped.period_s = stamped.elapsed_s / static_cast<double>(std::max<std::uint64_t>(steps, 1));
  if ((first || restarted || arrivals_.bunched) && description_.nominal_rate_hz > 0.0)
    stamped.period_s = 1.0 / description_.nominal_rate_hz;
  if (first) first_s_ = now;
  last_s_ = now;
  arrivals_.last_ns = sample.arrival_ns;
  ++accepted_;
  return stamped;
}

}  // namespace ifog
