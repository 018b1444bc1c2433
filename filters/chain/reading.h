// SPDX-License-Identifier: Apache-2.0
// What a sensor delivers, as plain structs: the same facts as the plugin interface's, so that filters know no
// devices.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "filters/settings/axes.h"

namespace ifog {

inline constexpr int kMaxChannels = 24;  // environment channels of one sensor, its own frame's and all others

enum class SensorKind {
  rate,         // rad/s, mean since the sample before
  delta_angle,  // rad, turned since the sample before
  angle,        // rad, turned since power-up; may wrap
};

// What a value may be; beyond it there is no measurement. Infinite: no such limit.
struct Limits {
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  double max_step = std::numeric_limits<double>::infinity();  // between two samples

  bool operator==(const Limits&) const = default;
};

// Constant while the sensor runs.
struct SensorFacts {
  SensorKind kind = SensorKind::rate;
  int axes = 1;                        // 1 … kMaxAxes
  std::uint32_t sequence_modulus = 0;  // the device's counter counts modulo this; 0: it sends none
  double nominal_rate_hz = 0.0;        // > 0
  double angle_wrap_rad = 0.0;         // SensorKind::angle: wraps modulo this; 0: it does not
  int frame_channels = 0;              // channels 0 … frame_channels − 1 come in the sensor's own frames
  int channels = 0;                    // all of them, ≤ kMaxChannels
  std::array<double, kMaxAxes> full_scale_radps{};  // rates at or beyond it are not measured; 0: not known
  Limits rate;                                      // of every axis, rad/s
  // Frame channels that are the specific force along x, y, z in m/s²; -1: there is none.
  std::array<int, kMaxAxes> acceleration_channel{-1, -1, -1};
  int temperature_channel = -1;              // likewise, the first in °C
  std::array<Limits, kMaxChannels> channel;  // of the channels of the sensor's own frames
};

// One sample as decoded.
struct Reading {
  // On an unslewed monotonic clock, ns; 0: unknown (a raw byte file, a backlog).
  std::int64_t arrival_ns = 0;
  std::int64_t came_ns = 0;        // arrival_ns, or the time of the read where that is 0; 0: offline, unknown
  std::int64_t wall_shift_ns = 0;  // time of day less that clock
  bool arrival_recorded = false;   // arrival_ns is from a recording, by a clock that may have been set
  std::optional<std::int64_t> device_time_ns;  // the device's clock as sent, any origin; none: it has none
  std::int64_t device_wrap_ns = 0;             // that clock rolls over after this; 0: never
  std::uint32_t at_once = 0;                   // samples in the same read; 0: unknown
  std::uint32_t sequence = 0;                  // as sent
  bool has_sequence = false;
  bool beyond_stated = false;  // a value is beyond the range that the format's description states
  std::uint32_t status = 0;
  std::uint32_t valid_axes = 0;  // bit i
  Axes value{};
  std::uint32_t fresh_channels = 0;            // bit i: frame channel i came with this sample
  std::array<double, kMaxChannels> channel{};  // NaN until known
  // Ages of channels that do not come in the sensor's frames, s; those of its own frames are counted here.
  std::array<float, kMaxChannels> channel_age_s{};
};

enum IncrementFlags : std::uint32_t {
  kGapBefore = 1,        // samples are missing before this one
  kMerged = 2,           // several samples in one, because the filter could not keep up
  kInvalid = 4,          // the device marks an axis invalid, or its value is none that can be
  kClockStep = 8,        // the wall clock has been set: utime has moved against the sample before, dt has not
  kAtFullScale = 16,     // the value reaches the end of the sensor's range, or is beyond; also kInvalid
  kSensorClockSet = 32,  // the device's own clock has been set: device_time_ns has moved, nothing else has
  kBeyondStated = 64,    // a value is beyond the range that the format's description states; it is kept
};

// The angle turned over one step, and what was measured with it.
struct Increment {
  std::int64_t utime_ns = 0;         // fitted time of the sample, time of day, ns since the epoch
  std::int64_t arrival_ns = 0;       // as in Reading
  std::int64_t came_ns = 0;          // likewise
  std::int64_t wall_shift_ns = 0;    // likewise
  std::int64_t device_time_ns = -1;  // the device's clock, over its wraps; −1: it has none
  std::uint64_t sequence = 0;        // unwrapped; starts at the device's first counter value
  double dt_s = 0.0;                 // since the sample before, gap included
  Axes delta_theta_rad{};            // only what the device sent: a gap adds nothing
  Axes covered_s{};                  // time delta_theta covers: dt less gap and invalid samples
  Axes rate_radps{};                 // delta_theta / covered; NaN where the axis is not valid
  Axes delta_v_mps{};                // specific force times time, of x, y, z where the frames have it
  Axes moved_s{};                    // time delta_v covers
  std::uint32_t valid_axes = 0;
  std::uint32_t stuck_axes = 0;  // of those: repeat one value, as the sensor sent it
  std::uint32_t status = 0;
  std::uint32_t flags = 0;
  std::uint32_t samples = 1;  // device samples in it
  std::array<double, kMaxChannels> channel{};
  std::array<float, kMaxChannels> channel_age_s{};
};

// Appends `later` to `into`: angles, times and counts add, so no angle is lost; all else is the later
// sample's.
void merge(Increment& into, const Increment& later) noexcept;

}  // namespace ifog
