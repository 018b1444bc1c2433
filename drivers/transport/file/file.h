// SPDX-License-Identifier: Apache-2.0
// File transport: raw bytes or a candump log from a file, FIFO or standard input, as fast as the reader or at
// recorded times.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "drivers/transport/transport.h"

namespace ifog {

struct FileSettings {
  enum class Format { bytes, candump };
  // free: as fast as the reader, without losses.
  // recorded: by absolute deadlines, like the device.
  enum class Pace { free, recorded };

  std::string path;  // "-" is standard input
  Format format = Format::bytes;
  Pace pace = Pace::free;
  double speed = 1.0;  // factor on the speed of recorded times
  double bytes_per_second =
      0.0;  // required for bytes at recorded pace; at free pace it spaces the arrival times
  std::uint32_t block_bytes = 0;  // size of blocks of recorded bytes, e.g. a frame; 0: 1 ms
  bool await_writer = true;       // wait for another writer of a FIFO; false: the file ends
  // candump: only this interface; empty: all, until frames of one id come on two, which is the end.
  std::string interface;
  std::vector<CanId> ids;  // candump: only frames of these ids; empty: all

  bool operator==(const FileSettings&) const = default;
};

// Arrival times: a candump log's own, at recorded pace shifted so that the first frame is now. For bytes, and
// lines without a time: the time of the read, or for bytes the time of opening plus bytes / bytes_per_second
// if given. .gz is read through zlib. The settings are checked where they are read (daemon/config).
std::unique_ptr<Transport> make_file_transport(FileSettings settings);

}  // namespace ifog
