// SPDX-License-Identifier: Apache-2.0
// Decodes a recording of a device's output by its driver: raw bytes or a candump log, plain or gzip. For
// flight recordings see drivers/flight.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/capture/candump/candump.h"
#include "drivers/capture/files/input_file.h"
#include "drivers/host/driver_instance.h"

namespace ifog {

enum class FileKind {
  capture,  // .csv; .h5, .hdf5
  candump,  // .log, .candump
  bytes,    // .bin, .kvh, .raw, .dat, .txt
  lcm_log,  // starts with an LCM event, or is called .lcm
  flight,   // starts like a flight recording, or is called .ifr
  unknown
};

// Kind of an output file by its ending (before .gz, any case); `unknown` if ambiguous.
FileKind file_kind(const std::string& path);
// Kind of an input file by its first bytes: flight recording, LCM event, candump line, header starting with
// time_s, HDF5 signature. Otherwise by its ending, except .txt and .dat. Otherwise `bytes` if it is not text,
// else `unknown`.
FileKind file_kind(const InputFile& file);

// True if a capture is HDF5, by its ending or first bytes. The signature may follow a block of 512 bytes to 2
// KiB of another program (MATLAB).
bool is_hdf5(const std::string& path);
bool is_hdf5(const InputFile& file);

struct RecordingCounts {
  std::size_t samples = 0;
  ifog_driver_counters driver{};
  std::uint64_t bytes_at_end = 0;  // bytes of an incomplete last frame; also in bytes_skipped
  CandumpLosses candump;
  bool packed_ends_early = false;  // the gzip stream is truncated; the available part was read
};

// One line per counter of losses: "3 frames with a wrong checksum", …
std::vector<std::string> losses(const RecordingCounts& counts);

// True if the driver needs this frame.
bool wants(const ifog_description& description, const ifog_can_frame& frame);

// Feeds the recording to the driver, as candump if it takes CAN frames, else as bytes. interface: only its
// frames of a candump log, "" for all. A log's frames have their recorded arrival times, raw bytes 0. Throws
// std::runtime_error with one line (file, line, what was expected), also if frames of one wanted id come from
// two interfaces.
RecordingCounts decode_recording(InputFile& file, DriverInstance& driver, const std::string& interface,
                                 const std::function<void(const ifog_sample&)>& sink);
// Ends a recording and counts bytes of an incomplete frame.
void finish_recording(DriverInstance& driver, RecordingCounts& counts);

}  // namespace ifog
