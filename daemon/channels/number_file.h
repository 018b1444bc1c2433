// SPDX-License-Identifier: Apache-2.0
// A file that holds one number and nothing else: hwmon, thermal zones, IIO.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "daemon/channels/channel_fault.h"

namespace ifog {

// Which writing of a file it was that was read. What the kernel makes up at each read (sysfs, procfs) is
// never the same.
struct FileWriting {
  dev_t device = 0;
  ino_t file = 0;
  std::int64_t written_ns = 0;
  bool made_at_each_read = true;

  [[nodiscard]] bool same(const FileWriting& other) const {
    return !made_at_each_read && !other.made_at_each_read && device == other.device && file == other.file &&
           written_ns == other.written_ns;
  }
};

// The number, or why there is none. Blanks and line ends may stand around it; every other character that is
// not of the number makes it none: half of "21,5" is no measurement.
std::variant<double, ChannelFault> number_in(std::string_view text);
// The same of a file's text. Never waits: a FIFO in the place of the file would hold up every other channel,
// and the end of the daemon.
std::variant<double, ChannelFault> read_number_file(const std::string& path, FileWriting& writing);

}  // namespace ifog
