// SPDX-License-Identifier: Apache-2.0
// Data of a sensor as plain structs, the same as in the plugin interface, so that filters do not depend on
// devices.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "filters/settings/axes.h"

namespace ifog {

// Environment channels of one sensor, in its own frames and elsewhere
inline constexpr int kMaxChannels = 24;

enum class SensorKind {
  rate,         // rad/s, mean since the previous sample
  delta_angle,  // rad, turned since the previous sample
  angle,        // rad, turned since power-up; may wrap
};

// Plausible range of a value. Infinite: no limit.
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
  std::uint32_t sequence_modulus = 0;  // modulus of the device's counter; 0: none
  double nominal_rate_hz = 0.0;        // > 0
  double speed = 1.0;                  // of arrivals: a recording is replayed at this multiple of its pace
  double angle_wrap_rad = 0.0;         // SensorKind::angle: modulus; 0: does not wrap
  int frame_channels = 0;              // channels 0 … frame_channels − 1 are in the sensor's own frames
  int channels = 0;                    // all of them, ≤ kMaxChannels
  std::array<double, kMaxAxes> full_scale_radps{};  // rates at or beyond it are invalid; 0: unknown
  Limits rate;                                      // of every axis, rad/s
  // Frame channels with the specific force along x, y, z in m/s²; -1: none.
  std::array<int, kMaxAxes> acceleration_channel{-1, -1, -1};
  int temperature_channel = -1;              // frame channel, °C; the first one
  std::array<Limits, kMaxChannels> channel;  // of frame channels
};

// One decoded sample.
struct Reading {
  // On an unslewed monotonic clock, ns; 0: unknown (raw byte file, backlog).
  std::int64_t arrival_ns = 0;
  std::int64_t read_ns = 0;        // arrival_ns, or the time of the read if that is 0; 0: offline, unknown
  std::int64_t wall_shift_ns = 0;  // time of day minus that clock
  bool arrival_recorded = false;   // arrival_ns is from a recording whose clock may have been set
  std::optional<std::int64_t> device_time_ns;  // device's clock as sent, any origin; nullopt: none
  std::int64_t device_wrap_ns = 0;             // rollover of that clock; 0: none
  std::uint32_t at_once = 0;                   // samples in the same read; 0: unknown
  std::uint32_t sequence = 0;                  // as sent
  bool has_sequence = false;
  bool beyond_stated = false;  // a value is beyond the range that the format's description states
  std::uint32_t status = 0;
  std::uint32_t valid_axes = 0;  // bit i
  Axes value{};
  std::uint32_t fresh_channels = 0;            // bit i: frame channel i is new in this sample
  std::array<double, kMaxChannels> channel{};  // NaN until known
  // Ages of channels that are not in the sensor's frames, s; frame channels' ages are counted by Incrementer.
  std::array<float, kMaxChannels> channel_age_s{};
};

enum IncrementFlags : std::uint32_t {
  kGapBefore = 1,        // samples are missing before this one
  kMerged = 2,           // several samples merged, because the filter was too slow
  kInvalid = 4,          // the device marks an axis invalid, or its value is implausible
  kClockStep = 8,        // the wall clock was set: utime has a step, dt has not
  kAtFullScale = 16,     // the value reaches or exceeds the sensor's range; also kInvalid
  kSensorClockSet = 32,  // the device's clock was set: only device_time_ns has a step
  kBeyondStated = 64,    // a value exceeds the range stated in the format's description; it is kept
};

// Angle turned over one step, and the data measured with it.
struct Increment {
  std::int64_t utime_ns = 0;         // fitted time of the sample, time of day, ns since the epoch
  std::int64_t arrival_ns = 0;       // as in Reading
  std::int64_t read_ns = 0;          // as in Reading
  std::int64_t wall_shift_ns = 0;    // as in Reading
  std::int64_t device_time_ns = -1;  // device's clock, unwrapped; −1: none
  std::uint64_t sequence = 0;        // unwrapped; starts at the device's first counter value
  double dt_s = 0.0;                 // since the previous sample, including a gap
  Axes delta_theta_rad{};            // as sent by the device: a gap adds nothing
  Axes covered_s{};                  // time of delta_theta: dt without gaps and invalid samples
  Axes rate_radps{};                 // delta_theta / covered; NaN for invalid axes
  Axes delta_v_mps{};                // specific force times time, of x, y, z if in the frames
  Axes moved_s{};                    // time of delta_v
  std::uint32_t valid_axes = 0;
  std::uint32_t stuck_axes = 0;  // axes of valid_axes that repeat one value
  std::uint32_t status = 0;
  std::uint32_t flags = 0;
  std::uint32_t samples = 1;  // number of device samples
  std::array<double, kMaxChannels> channel{};
  std::array<float, kMaxChannels> channel_age_s{};
};

// Merges `later` into `into`: angles, times and counts add up, so no angle is lost; the rest is the later
// sample's.
void merge(Increment& into, const Increment& later) noexcept;

}  // namespace ifog
