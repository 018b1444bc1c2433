// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/capture_builder.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "drivers/host/driver_instance.h"
#include "drivers/units/turn.h"
#include "drivers/units/units.h"

namespace ifog {
namespace {

constexpr double kGap = 1.5;  // in periods

double period_of(const ifog_description& description) {
  return description.nominal_rate_hz > 0.0 ? 1.0 / description.nominal_rate_hz : 1.0;
}

// True if samples of both become rows in the same way.
bool same_samples(const ifog_description& a, const ifog_description& b) {
  return a.kind == b.kind && a.sequence_modulus == b.sequence_modulus &&
         a.has_device_time == b.has_device_time && a.nominal_rate_hz == b.nominal_rate_hz &&
         a.angle_wrap_rad == b.angle_wrap_rad &&
         std::equal(a.full_scale, a.full_scale + a.axes, b.full_scale);
}

}  // namespace

CaptureBuilder::CaptureBuilder(const ifog_description& description, RowSink& sink,
                               const std::vector<std::string>& outside)
    : description_(description), times_(description), batch_(sink), before_(description.axes, kMissing) {
  std::vector<std::string> names = capture_columns(description);
  names.insert(names.end(), outside.begin(), outside.end());
  for (std::size_t i = description.axes; i < names.size(); ++i)
    channel_range_.push_back(measurable(names[i]));
  batch_.begin(names);
}

void CaptureBuilder::go_on_as(const ifog_description& description) {
  if (capture_columns(description) != capture_columns(description_))
    throw std::runtime_error(
        "continues with other axes or channels, as the driver's options changed; expected recordings of one");
  if (same_samples(description, description_)) return;
  description_ = description;
  last_.valid_axes = 0;  // no angle difference across this
  times_.go_on_as(description);
}

void CaptureBuilder::add_rates(const ifog_sample& sample, const SampleTimes::Stamped& stamped) {
  for (std::uint32_t i = 0; i < description_.axes; ++i) {
    double rate = kMissing;
    if ((sample.valid_axes & 1U << i) != 0) {
      if (description_.kind == IFOG_RATE) {
        rate = sample.value[i];
      } else if (description_.kind == IFOG_DELTA_ANGLE) {
        rate = sample.value[i] / stamped.period_s;
      } else if ((last_.valid_axes & 1U << i) != 0) {
        const double turned = sample.value[i] - last_.value[i];
        const double wrap = description_.angle_wrap_rad;
        const double rate_before = std::isnan(before_[i]) ? 0.0 : before_[i];
        const double usual = description_.nominal_rate_hz > 0.0 ? period_of(description_) : stamped.period_s;
        const double elapsed = stamped.elapsed_s;
        if (elapsed <= kGap * usual || turn_is_known(rate_before, elapsed, wrap))
          rate = (wrap > 0.0 ? std::remainder(turned, wrap) : turned) / elapsed;
      }
    }
    row_.push_back(rate);
  }
}

double CaptureBuilder::believable(std::size_t channel, double value) {
  if (std::isnan(value) || channel_range_[channel].holds(value)) return value;
  ++impossible_;
  return kMissing;
}

// Applies the limits of the daemon's chain to the new rates.
void CaptureBuilder::hold_to_what_can_be(const ifog_sample& sample) {
  bool at_end = false, beyond = false;
  for (std::uint32_t i = 0; i < description_.axes; ++i) {
    double& rate = row_[i];
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
  const std::optional<SampleTimes::Stamped> stamped = times_.next(sample);
  if (!stamped) return;
  row_.clear();
  if (stamped->restarted) last_.valid_axes = 0;  // no angle difference across this
  add_rates(sample, *stamped);
  hold_to_what_can_be(sample);
  for (std::uint32_t i = 0; i < description_.environments; ++i)
    row_.push_back(
        believable(i, (sample.environment_fresh & 1U << i) != 0 ? sample.environment[i] : kMissing));
  for (std::size_t i = description_.environments; i < channel_range_.size(); ++i) {
    const std::size_t o = i - description_.environments;
    row_.push_back(believable(i, o < outside.size() ? outside[o] : kMissing));
  }
  batch_.add(stamped->since_s, row_, times_.origin());
  std::swap(before_, row_);
  last_ = sample;
}

std::vector<std::string> not_measured_in_words(std::size_t at_full_scale, std::size_t implausible,
                                               std::size_t ambiguous) {
  std::vector<std::string> lines;
  const auto say = [&](std::size_t samples, const char* what) {
    if (samples != 0) lines.push_back(std::to_string(samples) + " samples " + what + ", treated as missing");
  };
  say(at_full_scale, "at or beyond the sensor's full scale");
  say(implausible, "with a rate that no sensor measures");
  if (ambiguous != 0)
    lines.push_back(
        std::to_string(ambiguous) +
        " of the missing samples are so by the device's clock alone: where that was set, none is, "
        "and no counter or time of arrival tells");
  return lines;
}

std::vector<std::string> CaptureBuilder::remarks() const {
  std::vector<std::string> lines;
  const auto say = [&](std::size_t count, const char* before, const char* behind) {
    if (count != 0) lines.push_back(before + std::to_string(count) + behind);
  };
  say(counts().missing, "", " samples are missing by the device's counter or clock");
  say(counts().restarts, "the device's counter or clock jumped back ", " times: was it switched off and on?");
  say(counts().clock_sets, "the device's clock was set ",
      " times while it measured on; there its times are by its counter or its rate");
  if (const std::string runs = clock_speed(times_.clock_runs()); !runs.empty())
    lines.push_back("the device's clock " + runs + " by the number of samples: is rate_hz right?");
  say(counts().repeated, "", " samples came twice or after one that follows, and are dropped");
  say(counts().mixed, "", " samples come from two devices, mixed, and are dropped: which of them is wanted?");
  say(impossible_, "", " values of channels cannot be, in the unit of their name: dropped");
  for (std::string& line : not_measured_in_words(at_full_scale_, implausible_, counts().ambiguous))
    lines.push_back(std::move(line));
  return lines;
}

}  // namespace ifog
