// SPDX-License-Identifier: Apache-2.0
// The file transport: raw bytes or a candump log from a file, a FIFO or the standard input, as fast as the
// reader takes them or at recorded times.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "drivers/transport/transport.h"

namespace ifog {

struct FileSettings {
  enum class Format { bytes, candump };
  // free: as fast as the reader takes it, nothing is lost when it pauses.
  // recorded: against absolute deadlines, as the device would have delivered.
  enum class Pace { free, recorded };

  std::string path;  // "-" is the standard input
  Format format = Format::bytes;
  Pace pace = Pace::free;
  double speed = 1.0;  // recorded times go by this many times faster
  double bytes_per_second =
      0.0;  // bytes at recorded pace: required. At free pace it spaces the arrival times
  std::uint32_t block_bytes =
      0;                     // recorded bytes come in blocks of this, a device's frame; 0: what 1 ms brings
  bool await_writer = true;  // a FIFO whose writer goes away waits for the next one; false: it has ended
  // candump: frames of this interface only; empty: all, until frames of one id come on two, where it ends.
  std::string interface;
  std::vector<CanId> ids;  // candump: frames of these ids only; empty: all
};

// Arrival times: a candump log's own, at recorded pace moved so that the first frame is now; bytes, and
// candump lines without a time: the moment of the read, or for bytes the moment of opening plus bytes /
// bytes_per_second where that is given. A .gz file is read through zlib. Throws std::runtime_error on
// settings that contradict each other.
std::unique_ptr<Transport> make_file_transport(FileSettings settings);

}  // namespace ifog
