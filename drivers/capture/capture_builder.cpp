// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/capture_builder.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "drivers/units/turn.h"

namespace ifog {
namespace {

constexpr double kGap = 1.5;  // in periods

bool never_known(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isnan(value); });
}

double period_of(const ifog_description& description) {
  return description.nominal_rate_hz > 0.0 ? 1.0 / description.nominal_rate_hz : 1.0;
}
// Columns of a driver's samples: axes, then channels.
std::vector<std::string> columns_of(const ifog_description& description) {
  std::vector<std::string> out;
  for (std::uint32_t i = 0; i < description.axes; ++i)
    out.push_back("rate " + std::string(description.axis[i]));
  for (std::uint32_t i = 0; i < description.environments; ++i) out.emplace_back(description.environment[i]);
  return out;
}

// True if samples of both become rows in the same way.
bool same_samples(const ifog_description& a, const ifog_description& b) {
  return a.kind == b.kind && a.sequence_modulus == b.sequence_modulus &&
         a.has_device_time == b.has_device_time && a.nominal_rate_hz == b.nominal_rate_hz &&
         a.angle_wrap_rad == b.angle_wrap_rad &&
         std::equal(a.full_scale, a.full_scale + a.axes, b.full_scale);
}

}  // namespace

CaptureBuilder::CaptureBuilder(const ifog_description& description, const std::vector<std::string>& outside)
    : description_(description), times_(description) {
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
        const std::vector<double>& before = capture_.rate_radps[i];
        const double rate_before = before.empty() || std::isnan(before.back()) ? 0.0 : before.back();
        const double usual = description_.nominal_rate_hz > 0.0 ? period_of(description_) : stamped.period_s;
        const double elapsed = stamped.elapsed_s;
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

// Applies the limits of the daemon's chain to the new rates.
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
  const std::optional<SampleTimes::Stamped> stamped = times_.next(sample);
  if (!stamped) return;
  capture_.origin = times_.origin();
  capture_.time_s.push_back(stamped->since_s);
  if (stamped->restarted) last_.valid_axes = 0;  // no angle difference across this
  add_rates(sample, *stamped);
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
  say(counts().repeated, "", " samples came twice or after one that follows, and are dropped");
  say(counts().mixed, "", " samples come from two devices, mixed, and are dropped: which of them is wanted?");
  say(impossible_, "", " values of channels cannot be, in the unit of their name: dropped");
  for (std::string& line : not_measured_in_words(at_full_scale_, implausible_, counts().ambiguous))
    lines.push_back(std::move(line));
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
