// SPDX-License-Identifier: Apache-2.0
// Replays a flight recording through a driver: the same samples as in the daemon, with the same external
// channels at the same times.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "drivers/flight/entry.h"
#include "drivers/flight/flight_reader.h"
#include "drivers/host/driver_instance.h"

namespace ifog {

struct RecordedSample {
  const ifog_sample& sample;
  std::int64_t read_ns;                   // arrival, or time of the read if that is unknown; arrival clock
  std::span<const ChannelValue> outside;  // external channels at that time, in the header's order
  std::int64_t wall_shift_ns;             // change of the wall clock since the arrival clock started
};

struct RecordedSamples {
  std::function<void(const RecordedSample&)> sample;
  std::function<void()> discontinuity;  // the device was reopened, or part of the recording is missing
  // Called before a discontinuity that the daemon did not have (missing recording). May be empty.
  std::function<void()> missing{};
  // Called when another file starts, before its samples; it may be of another run or have other settings. The
  // driver may be replaced here by one with the header's options. May be empty.
  std::function<void(const FlightHeader&)> file{};
  // Called with the number of samples, next or just before, that were merged before the daemon's filter. May
  // be empty.
  std::function<void(std::uint64_t)> merged{};
};

// Decodes everything from `reader`. Throws std::runtime_error, without the file's name, if a later file is of
// another sensor, driver or kind.
void decode_flight(FlightReader& reader, DriverInstance& driver, const RecordedSamples& sink);

// Frame of a `can` entry; false if it is invalid. arrival_ns is 0 if unknown.
bool frame_of(const FlightEntry& entry, ifog_can_frame& frame) noexcept;

}  // namespace ifog
