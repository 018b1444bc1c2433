// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/capture_builder.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "drivers/capture/time_stamps.h"
#include "drivers/host/timeline_frame.h"
#include "drivers/ifog/turn.h"

namespace ifog {
namespace {

constexpr double kGap = 1.5;  // periods from one sample to the next

bool never_known(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isnan(value); });
}

double period_of(const ifog_description& description) {
  return description.nominal_rate_hz > 0.0 ? 1.0 / description.nominal_rate_hz : 1.0;
}
DeviceTimeline timeline_of(const ifog_description& description) {
  return {description.sequence_modulus, description.nominal_rate_hz};
}

// Of the frames: axes, then channels.
std::vector<std::string> columns_of(const ifog_description& description) {
  std::vector<std::string> out;
  for (std::uint32_t i = 0; i < description.axes; ++i)
    out.push_back("rate " + std::string(description.axis[i]));
  for (std::uint32_t i = 0; i < description.environments; ++i) out.emplace_back(description.environment[i]);
  return out;
}

// Of the same columns: samples of both become rows in the same way.
bool same_samples(const ifog_description& a, const ifog_description& b) {
  return a.kind == b.kind && a.sequence_modulus == b.sequence_modulus &&
         a.has_device_time == b.has_device_time && a.nominal_rate_hz == b.nominal_rate_hz &&
         a.angle_wrap_rad == b.angle_wrap_rad &&
         std::equal(a.full_scale, a.full_scale + a.axes, b.full_scale);
}

// Whatever a device says: what has no room wraps, and is a clock that jumps.
std::int64_t ns_since(const TimeOrigin& origin, std::int64_t time_ns) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(time_ns) -
                                   static_cast<std::uint64_t>(origin.s) * 1'000'000'000U -
                                   static_cast<std::uint64_t>(origin.ns));
}

}  // namespace

CaptureBuilder::CaptureBuilder(const ifog_description& description, const std::vector<std::string>& outside)
    : description_(description), timeline_(timeline_of(description)) {
  for (std::uint32_t i = 0; i < description.axes; ++i) capture_.axes.emplace_back(description.axis[i]);
  capture_.rate_radps.resize(description.axes);
  capture_.reference_rate_radps.resize(description.axes);
  for (std::uint32_t i = 0; i < description.environments; ++i)
    capture_.channels.push_back({description.environment[i], {}});
  for (const std::string& name : outside) capture_.channels.push_back({name, {}});
  for (const CaptureColumn& channel : capture_.channels) channel_range_.push_back(measurable(channel.name));
}

void CaptureBuilder::go_on_as(const ifog_description& description) {
  if (columns_of(description) != columns_of(description_))
    throw std::runtime_error(
        "goes on with other axes or channels, as the driver's options changed; expected recordings of one");
  if (same_samples(description, description_)) return;
  description_ = description;
  timeline_ = timeline_of(description);
  clock_ = Clock::undecided;
  broken_ = true;
}

void CaptureBuilder::choose_clock(const ifog_sample& sample) {
  first_arrival_ns_ = sample.arrival_ns;
  const bool rate_known = description_.nominal_rate_hz > 0.0;
  if ((sample.flags & IFOG_SAMPLE_DEVICE_TIME) != 0) {
    clock_ = Clock::device;
    device_from_ = TimeOrigin::of(sample.device_time_ns);
    if (taken_ + capture_.size() == 0) capture_.origin = device_from_;
  } else if ((sample.flags & IFOG_SAMPLE_SEQUENCE) != 0 && rate_known) {
    clock_ = Clock::counter;
  } else if (sample.arrival_ns != 0) {
    clock_ = Clock::arrival;
  } else if (rate_known) {
    clock_ = Clock::number;
  } else {
    throw std::runtime_error(
        "the samples carry no time: expected the option rate_hz with the samples a second of the device");
  }
}

DeviceTimeline::Step CaptureBuilder::step_to(const ifog_sample& sample) {
  const DeviceTimeline::Frame frame = timeline_frame(sample, description_.axes);
  if (timeline_.tells(frame)) return timeline_.next(frame);
  DeviceTimeline::Step step;
  step.time_ns = timeline_.first(frame);
  return step;
}

double CaptureBuilder::seconds(const ifog_sample& sample) const {
  constexpr double kNsPerSecond =
      1e9;  // divided by, so that the result is the double nearest to the decimal time
  switch (clock_) {
    case Clock::device:
      return static_cast<double>(ns_since(device_from_, device_ns_)) / kNsPerSecond + offset_s_;
    case Clock::arrival:
      return static_cast<double>(sample.arrival_ns - first_arrival_ns_) / kNsPerSecond + offset_s_;
    default:
      return static_cast<double>(count_) / description_.nominal_rate_hz + offset_s_;
  }
}

// The sample's clock is set so that it comes as much later than the one before as it arrived later.
void CaptureBuilder::begin_anew(const ifog_sample& sample) {
  broken_ = false;
  const double later_s = static_cast<double>(sample.arrival_ns - last_.arrival_ns) * 1e-9;
  const double rate_hz = description_.nominal_rate_hz;
  const double least_s = rate_hz > 0.0 ? 1.0 / rate_hz : 1e-6;
  const bool known = sample.arrival_ns != 0 && last_.arrival_ns != 0;
  offset_s_ += last_s_ + std::max(known ? later_s : 0.0, least_s) - seconds(sample);
  last_.valid_axes = 0;  // no difference of angles over it
}

void CaptureBuilder::refuse(double now) const {
  const auto told = [this](double time_s) {
    std::string text;
    append_time(text, capture_.origin, time_s);
    return text;
  };
  throw std::runtime_error("sample " + std::to_string(taken_ + capture_.size() + 1) + ": its time is " +
                           told(now) + " s by " +
                           (clock_ == Clock::device    ? "the device's clock"
                            : clock_ == Clock::counter ? "its counter"
                                                       : "its arrival") +
                           ", expected more than the " + told(last_s_) + " s of the sample before");
}

void CaptureBuilder::add_rates(const ifog_sample& sample, double elapsed, double period) {
  for (std::uint32_t i = 0; i < description_.axes; ++i) {
    double rate = kMissing;
    if ((sample.valid_axes & 1U << i) != 0) {
      if (description_.kind == IFOG_RATE) {
        rate = sample.value[i];
      } else if (description_.kind == IFOG_DELTA_ANGLE) {
        rate = sample.value[i] / period;
      } else if ((last_.valid_axes & 1U << i) != 0) {
        const double turned = sample.value[i] - last_.value[i];
        const double wrap = description_.angle_wrap_rad;
        const std::vector<double>& before = capture_.rate_radps[i];
        const double rate_before = before.empty() || std::isnan(before.back()) ? 0.0 : before.back();
        const double usual = description_.nominal_rate_hz > 0.0 ? period_of(description_) : period;
        if (elapsed <= kGap * usual || turn_is_known(rate_before, elapsed, wrap))
          rate = (wrap > 0.0 ? std::remainder(turned, wrap) : turned) / elapsed;
      }
    }
    capture_.rate_radps[i].push_back(rate);
  }
}

double CaptureBuilder::believable(std::size_t channel, double value) {
  if (std::isnan(value) || channel_range_[channel].holds(value)) return value;
  ++impossible_;
  return kMissing;
}

// Of the rates just added: the same limits that the daemon's chain has.
void CaptureBuilder::hold_to_what_can_be(const ifog_sample& sample) {
  bool at_end = false, beyond = false;
  for (std::uint32_t i = 0; i < description_.axes; ++i) {
    double& rate = capture_.rate_radps[i].back();
    const double full_scale = description_.full_scale[i];
    const bool marked =
        (sample.valid_axes & 1U << i) == 0 || (description_.kind == IFOG_ANGLE && std::isnan(rate));
    const bool saturated = full_scale > 0.0 && std::abs(rate) >= full_scale;
    if (marked || (!saturated && std::abs(rate) <= IFOG_MAX_RATE)) continue;
    (saturated ? at_end : beyond) = true;
    rate = kMissing;
  }
  at_full_scale_ += at_end ? 1 : 0;
  implausible_ += beyond ? 1 : 0;
}

void CaptureBuilder::add(const ifog_sample& sample, std::span<const double> outside) {
  const bool first = taken_ + capture_.size() == 0;
  if (clock_ == Clock::undecided) choose_clock(sample);
  bool anew = broken_ && !first;
  DeviceTimeline::Step step;
  if (first || anew)
    step.time_ns = timeline_.first(timeline_frame(sample, description_.axes));
  else
    step = step_to(sample);
  if (step.out_of_turn) {
    ++repeated_;
    return;
  }
  const std::uint64_t steps = first || anew ? 0 : step.samples;
  const bool timed_anew =
      step.restarted && (restarts_ || clock_ != Clock::device || sample.device_wrap_ns > 0);
  count_ += steps;
  if (steps > 1) missing_ += steps - 1;
  if (timed_anew) ++restarted_;
  device_ns_ = step.time_ns;
  anew = anew || (timed_anew && clock_ == Clock::device);
  if (anew) begin_anew(sample);
  broken_ = false;
  if (step.clock_set) ++clock_sets_;
  // Where the device's clock has stood still while it measured, by the sum of its steps; where it was set
  // while the device counted on, by the counter.
  if (!first && !anew && clock_ == Clock::device && (timeline_.clock_stood() || step.by_count))
    offset_s_ += last_s_ + step.dt_s - seconds(sample);
  double now = seconds(sample);
  if (!first && now <= last_s_) {
    if (!restarts_) refuse(now);
    if (now == last_s_) {
      ++repeated_;
      return;
    }
    anew = true;
    begin_anew(sample);
    now = seconds(sample);
  }
  const double elapsed = first ? kMissing : now - last_s_;
  double period = elapsed / static_cast<double>(std::max<std::uint64_t>(steps, 1));
  if ((first || anew) && description_.nominal_rate_hz > 0.0) period = 1.0 / description_.nominal_rate_hz;

  capture_.time_s.push_back(now);
  last_s_ = now;
  add_rates(sample, elapsed, period);
  for (std::uint32_t i = 0; i < description_.environments; ++i)
    capture_.channels[i].values.push_back(
        believable(i, (sample.environment_fresh & 1U << i) != 0 ? sample.environment[i] : kMissing));
  for (std::size_t i = description_.environments; i < capture_.channels.size(); ++i) {
    const std::size_t o = i - description_.environments;
    capture_.channels[i].values.push_back(believable(i, o < outside.size() ? outside[o] : kMissing));
  }
  hold_to_what_can_be(sample);
  last_ = sample;
}

std::vector<std::string> not_measured_in_words(std::size_t at_full_scale, std::size_t implausible) {
  std::vector<std::string> lines;
  const auto say = [&](std::size_t samples, const char* what) {
    if (samples != 0) lines.push_back(std::to_string(samples) + " samples " + what + ", taken for missing");
  };
  say(at_full_scale, "at or beyond the sensor's full scale");
  say(implausible, "with a rate that no sensor measures");
  return lines;
}

std::vector<std::string> CaptureBuilder::names() const {
  std::vector<std::string> out;
  for (const std::string& axis : capture_.axes)
    out.push_back(axis.empty() ? "rate_radps" : "rate_" + axis + "_radps");
  for (const CaptureColumn& channel : capture_.channels) out.push_back(channel.name);
  return out;
}

void CaptureBuilder::next_rows(RowBlock& rows) {
  taken_ += capture_.size();
  rows.columns.clear();
  rows.origin = capture_.origin;
  rows.time_s = std::exchange(capture_.time_s, {});
  for (std::vector<double>& rate : capture_.rate_radps) rows.columns.push_back(std::exchange(rate, {}));
  for (CaptureColumn& channel : capture_.channels) rows.columns.push_back(std::exchange(channel.values, {}));
}

Capture CaptureBuilder::finish() {
  if (capture_.time_s.empty()) throw std::runtime_error("holds no sample that the driver understands");
  for (std::size_t i = capture_.axes.size(); i-- > 0;) {
    if (!never_known(capture_.rate_radps[i])) continue;
    capture_.dead_axes.push_back(capture_.axes[i]);
    capture_.axes.erase(capture_.axes.begin() + static_cast<std::ptrdiff_t>(i));
    capture_.rate_radps.erase(capture_.rate_radps.begin() + static_cast<std::ptrdiff_t>(i));
    capture_.reference_rate_radps.pop_back();
  }
  if (capture_.axes.empty()) throw std::runtime_error("the device marks every value of every axis invalid");
  std::erase_if(capture_.channels, [](const CaptureColumn& channel) { return never_known(channel.values); });
  return std::move(capture_);
}

}  // namespace ifog
