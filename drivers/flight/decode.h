// SPDX-License-Identifier: Apache-2.0
// A flight recording through a driver again: the samples come as the daemon had them, with the same channels
// from elsewhere at the same times.
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
  std::int64_t read_ns;                   // when it came, or was read where that is not known; arrival clock
  std::span<const ChannelValue> outside;  // channels from elsewhere, as they were then; in the header's order
  std::int64_t wall_shift_ns;             // how far the wall clock had been set since the arrival clock began
};

struct RecordedSamples {
  std::function<void(const RecordedSample&)> sample;
  std::function<void()>
      discontinuity;  // the device was opened again, or something of the recording is missing
  // Before a discontinuity that the daemon did not have: something of the recording is missing. May be empty.
  std::function<void()> missing{};
  // A file begins behind the first, before its samples: of another run, or with other settings, perhaps. The
  // driver may be exchanged here for one with the options that the header names. May be empty.
  std::function<void(const FlightHeader&)> file{};
  // So many of the next samples, or of those just before, were merged into others before the daemon's filter.
  // May be empty.
  std::function<void(std::uint64_t)> merged{};
};

// The next sample onto whatever `reader` gives, to its end. Throws std::runtime_error, without the file's
// name: a file of another sensor, driver or kind behind the first.
void decode_flight(FlightReader& reader, DriverInstance& driver, const RecordedSamples& sink);

// A frame of a `can` entry; false: no frame that CAN has. Its arrival_ns is 0 where it is not known.
bool frame_of(const FlightEntry& entry, ifog_can_frame& frame) noexcept;

}  // namespace ifog
