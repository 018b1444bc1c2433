// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/capture_encoder.h"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "drivers/ifog/quoted.h"
#include "drivers/row_times/sample_clock.h"

namespace ifog {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::string seven_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.7g", value);
  return text;
}

std::size_t driver_axis(const ifog_description& d, const std::string& name) {
  std::vector<std::string> names(d.axis, d.axis + d.axes);
  if (const auto found = std::ranges::find(names, name); found != names.end())
    return static_cast<std::size_t>(found - names.begin());
  std::ranges::replace(names, "", "one without a name");
  throw std::runtime_error("the driver has no axis " + in_quotes(name) +
                           ", expected one of: " + boost::join(names, ", "));
}

// Sample rate to seven digits, because decimal times are not exact in binary: 1 / (0.015 − 0.010) is not quite 200. "0"
// without a step.
std::string rate_of(const CaptureView& capture) {
  return capture.size() < 2 ? "0" : seven_digits(1.0 / sample_clock(capture.time_s).period_s);
}

}  // namespace

DriverSettings with_rate(const CaptureView& capture, const Plugin& plugin, DriverSettings settings) {
  const ifog_option* option = plugin.table().options;
  while (option->key != nullptr && std::string(option->key) != "rate_hz") ++option;
  if (option->key != nullptr && capture.size() > 1) settings.try_emplace("rate_hz", rate_of(capture));
  return settings;
}

CaptureEncoder::CaptureEncoder(CaptureView capture, DriverInstance& driver, const std::string& axis)
    : capture_(std::move(capture)), driver_(driver), angle_(capture_.axes.size(), 0.0) {
  const ifog_description& d = driver.description();
  rate_hz_ = d.nominal_rate_hz > 0.0 ? d.nominal_rate_hz : std::strtod(rate_of(capture_).c_str(), nullptr);
  timed_ = d.has_device_time != 0 || driver.takes_can();
  const double first_s = capture_.size() > 0 ? capture_.origin.in_s(capture_.time_s.front()) : 0;
  if (timed_ && first_s < 0.0) {
    later_s_ = static_cast<std::int64_t>(std::ceil(-first_s));
    notices_.push_back("begins at " + seven_digits(first_s) +
                       " s, and no clock of a device shows times before 0: all are sent " +
                       std::to_string(later_s_) + " s later");
  }
  if (capture_.axes.size() == 1) {
    const std::string& own = capture_.axes.front();
    const bool by_own_name = axis.empty() && !own.empty() && d.axes > 1;
    axis_of_.push_back(!axis.empty() ? driver_axis(d, axis) : by_own_name ? driver_axis(d, own) : 0);
  } else {
    if (!axis.empty())
      throw std::runtime_error("--axis is " + in_quotes(axis) +
                               ", expected none for a capture of several axes");
    for (const std::string& name : capture_.axes) axis_of_.push_back(driver_axis(d, name));
  }
  for (std::size_t i = 0; i < capture_.axes.size(); ++i)
    if (!capture_.reference_rate_radps[i].empty())
      notices_.push_back("not sent, as no device does: the reference rate" +
                         (capture_.axes[i].empty() ? "" : " of axis " + capture_.axes[i]));

  channels_.resize(d.environments);
  std::vector<std::string> without_place, without_column;
  for (const CaptureView::Channel& channel : capture_.channels) {
    std::size_t at = 0;
    while (at < d.environments && channel.name != d.environment[at]) ++at;
    if (at < d.environments)
      channels_[at] = channel.values;
    else
      without_place.push_back(channel.name);
  }
  for (std::uint32_t i = 0; i < d.environments; ++i)
    if (channels_[i].empty()) without_column.emplace_back(d.environment[i]);
  if (!without_place.empty())
    notices_.push_back("not sent, as the format as set up has no place for it: " +
                       boost::join(without_place, ", "));
  if (!without_column.empty())
    notices_.push_back(
        "no data for these fields, sent as invalid, or as 0 where the format has no invalid: " +
        boost::join(without_column, ", "));

  std::fill(std::begin(sample_.environment), std::end(sample_.environment), kMissing);
}

ifog_sample CaptureEncoder::next_sample() {
  const ifog_description& d = driver_.description();
  const double now = capture_.time_s[rows_.at];
  const bool first = rows_done() == 0;
  const double elapsed = first ? 1.0 / rate_hz_ : now - before_s_;
  const double periods = elapsed * rate_hz_;
  // Less than 1.5 periods are jitter, not a missing row.
  const std::uint64_t steps = periods < 1.5 ? 1 : static_cast<std::uint64_t>(std::llround(periods));
  if (!first) {
    count_ += steps;
    elapsed_s_ += elapsed;
    const std::uint64_t modulus = d.sequence_modulus;
    const std::uint64_t shown = modulus == 0 ? 1 : (steps - 1) % modulus + 1;
    encoded_s_ += static_cast<double>(shown) / rate_hz_;
  }

  sample_.arrival_ns =
      (capture_.origin.s + later_s_) * kSecond_ns + capture_.origin.ns + std::llround(now * 1e9);
  sample_.device_time_ns = sample_.arrival_ns;
  sample_.flags = IFOG_SAMPLE_DEVICE_TIME;
  if (d.sequence_modulus != 0) {
    sample_.flags |= IFOG_SAMPLE_SEQUENCE;
    sample_.sequence = static_cast<std::uint32_t>(count_ % d.sequence_modulus);
  }
  sample_.valid_axes = 0;
  std::fill(std::begin(sample_.value), std::end(sample_.value), kMissing);
  bool at_full_scale = false;
  for (std::size_t i = 0; i < axis_of_.size(); ++i) {
    const double rate = capture_.rate_radps[i][rows_.at];
    const double full_scale = d.full_scale[axis_of_[i]];
    at_full_scale = at_full_scale || (full_scale > 0.0 && std::abs(rate) >= full_scale);
    double value = rate;
    if (d.kind == IFOG_DELTA_ANGLE) value = rate * elapsed / static_cast<double>(steps);
    if (d.kind == IFOG_ANGLE && !std::isnan(rate)) {
      angle_[i] += rate * elapsed;
      value = d.angle_wrap_rad > 0.0 ? std::remainder(angle_[i], d.angle_wrap_rad) : angle_[i];
    }
    if (std::isnan(value)) continue;
    sample_.value[axis_of_[i]] = value;
    sample_.valid_axes |= 1U << axis_of_[i];
  }
  rows_.at_full_scale += at_full_scale ? 1 : 0;
  sample_.environment_fresh = 0;
  for (std::uint32_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].empty() || std::isnan(channels_[i][rows_.at])) continue;
    sample_.environment[i] = channels_[i][rows_.at];
    sample_.environment_fresh |= 1U << i;
  }
  return sample_;
}

template <typename Out>
bool CaptureEncoder::encode_next(Out& out, void (DriverInstance::*encode)(const ifog_sample&, Out&)) {
  if (rows_.at == capture_.size()) return false;
  ifog_sample sample = next_sample();
  const ifog_description& d = driver_.description();
  // An unsigned angle starts at 0 instead of minus half a turn.
  for (bool once_more = d.kind == IFOG_ANGLE && d.angle_wrap_rad > 0.0;; once_more = false) try {
      (driver_.*encode)(sample, out);
      break;
    } catch (const std::runtime_error& error) {
      std::string at;
      append_time(at, capture_.origin, capture_.time_s[rows_.at]);
      rows_.dropped += sample.valid_axes == 0 ? 1 : 0;
      if (sample.valid_axes == 0) break;
      if (!once_more) throw std::runtime_error("at " + at + " s: " + error.what());
      for (double& value : sample.value)
        if (value < 0.0) value += d.angle_wrap_rad;
    }
  before_s_ = capture_.time_s[rows_.at++];
  return true;
}

bool CaptureEncoder::next(std::vector<std::uint8_t>& bytes) {
  return encode_next(bytes, &DriverInstance::encode_bytes);
}

bool CaptureEncoder::next(std::vector<ifog_can_frame>& frames) {
  return encode_next(frames, &DriverInstance::encode_can);
}

}  // namespace ifog
