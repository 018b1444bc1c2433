// SPDX-License-Identifier: Apache-2.0
#include "daemon/sensor/facts.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "daemon/config/config.h"
#include "drivers/capture/columns/column_names.h"
#include "filters/chain/plausibility.h"

namespace ifog {

static_assert(kMaxAxes == IFOG_MAX_AXES && kMaxChannels >= IFOG_MAX_ENVIRONMENT,
              "the chain must hold whatever a plugin may deliver");
static_assert(kMostRate_radps == IFOG_MAX_RATE && kMostChannel == IFOG_MAX_ENVIRONMENT_VALUE,
              "the chain must check plugins against the interface");

SensorFacts sensor_facts(const ifog_description& description, double nominal_rate_hz, int outside_channels) {
  SensorFacts facts;
  facts.kind = description.kind == IFOG_RATE          ? SensorKind::rate
               : description.kind == IFOG_DELTA_ANGLE ? SensorKind::delta_angle
                                                      : SensorKind::angle;
  facts.axes = static_cast<int>(description.axes);
  facts.sequence_modulus = description.sequence_modulus;
  facts.nominal_rate_hz = nominal_rate_hz > 0.0 ? nominal_rate_hz : description.nominal_rate_hz;
  if (!(facts.nominal_rate_hz > 0.0))
    throw KeyError("nominal_rate_hz",
                   "the driver does not know the sample rate: nominal_rate_hz must be given");
  facts.angle_wrap_rad = description.angle_wrap_rad;
  std::copy_n(description.full_scale, kMaxAxes, facts.full_scale_radps.begin());
  facts.frame_channels = static_cast<int>(description.environments);
  facts.channels = facts.frame_channels + outside_channels;
  for (int c = 0; c < std::min(facts.frame_channels, kMaxChannels); ++c)
    facts.channel[static_cast<std::size_t>(c)] = channel_limits(description.environment[c], {});
  constexpr std::array<std::string_view, kMaxAxes> kAccelerations{"accel_x_mps2", "accel_y_mps2",
                                                                  "accel_z_mps2"};
  for (int c = 0; c < facts.frame_channels; ++c)
    for (std::size_t axis = 0; axis < kMaxAxes; ++axis)
      if (kAccelerations[axis] == description.environment[c]) facts.acceleration_channel[axis] = c;
  for (int c = facts.frame_channels - 1; c >= 0; --c)
    if (std::string_view(description.environment[c]).ends_with("_degC")) facts.temperature_channel = c;
  if (facts.channels > kMaxChannels)
    throw KeyError("channel", std::to_string(facts.channels) + " channels, expected at most " +
                                  std::to_string(kMaxChannels));
  return facts;
}

Limits channel_limits(const std::string& name, const Limits& said) {
  const Measurable can_be = measurable(name);
  Limits out = said;
  out.minimum = std::max(said.minimum, can_be.least);
  out.maximum = std::min(said.maximum, can_be.most);
  return out;
}

void read_sample(const ifog_sample& sample, int frame_channels, Reading& out) noexcept {
  out.arrival_ns = sample.arrival_ns;
  out.device_time_ns.reset();
  if ((sample.flags & IFOG_SAMPLE_DEVICE_TIME) != 0) out.device_time_ns = sample.device_time_ns;
  out.device_wrap_ns = sample.device_wrap_ns;
  out.at_once = sample.at_once;
  out.sequence = sample.sequence;
  out.has_sequence = (sample.flags & IFOG_SAMPLE_SEQUENCE) != 0;
  out.beyond_stated = (sample.flags & IFOG_SAMPLE_BEYOND) != 0;
  out.status = sample.status;
  out.valid_axes = sample.valid_axes;
  std::copy_n(sample.value, kMaxAxes, out.value.begin());
  out.fresh_channels = sample.environment_fresh;
  std::copy_n(sample.environment, frame_channels, out.channel.begin());
}

}  // namespace ifog
