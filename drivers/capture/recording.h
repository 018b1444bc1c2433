// SPDX-License-Identifier: Apache-2.0
// A recording of what a device sent, put through its driver: raw bytes, or a candump log. Plain or gzip.
// Flight recordings have a way of their own (drivers/flight).
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
  lcm_log,  // begins with an LCM event, or is called .lcm
  flight,   // begins as a flight recording, or is called .ifr
  unknown
};

// By the ending (before .gz, in small letters or capitals); `unknown` where it does not tell. For a file that
// is to be written.
FileKind file_kind(const std::string& path);
// By the first bytes where they tell: a flight recording's, an LCM event, a line of candump, a header that
// begins with time_s, HDF5's signature. Else by the ending, of which .txt and .dat say nothing. Else what is
// no text is `bytes`; a text that is none of these is `unknown`.
FileKind file_kind(const InputFile& file);

// Which of the two a capture is, by its ending and, of a file that is there, by its first bytes: HDF5 begins
// so, or behind the 512 bytes to 2 KiB that another program (MATLAB) has put before it.
bool is_hdf5(const std::string& path);
bool is_hdf5(const InputFile& file);

struct RecordingCounts {
  std::size_t samples = 0;
  ifog_driver_counters driver{};
  std::uint64_t bytes_at_end = 0;  // a frame that the file ends within; also in bytes_skipped
  CandumpLosses candump;
  bool packed_ends_early = false;  // the gzip stream: what is there was read
};

// "3 frames with a wrong checksum", … : one line for each counter that says something was lost.
std::vector<std::string> losses(const RecordingCounts& counts);

// Whether a driver is to get this frame.
bool wants(const ifog_description& description, const ifog_can_frame& frame);
// The line for a candump log in which frames of one id come on two interfaces.
std::string two_interfaces(const std::string& path, std::string_view one, std::string_view other);

// Feeds the whole recording to the driver, as `candump` if the driver takes CAN frames, else as bytes; of a
// candump log only one interface's frames unless `interface` is empty. A log's frames arrive at their
// recorded times; raw bytes have none and arrive at 0. Frames of one id that the driver wants, on two
// interfaces, are refused. Throws std::runtime_error with one line (file, line, what was expected).
RecordingCounts decode_recording(InputFile& file, DriverInstance& driver, const std::string& interface,
                                 const std::function<void(const ifog_sample&)>& sink);
// Ends a recording: bytes that the driver still waits to complete are counted.
void finish_recording(DriverInstance& driver, RecordingCounts& counts);

}  // namespace ifog
