// SPDX-License-Identifier: Apache-2.0
// Reads a file that contains a single number: hwmon, thermal zones, IIO.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "daemon/channels/channel_fault.h"

namespace ifog {

// Identifies a version of a file. For files generated at each read (sysfs, procfs) it always differs.
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

// The number, or the reason why there is none. Blanks and line ends may surround it; other characters make it
// invalid, such as "21,5".
std::variant<double, ChannelFault> number_in(std::string_view text);
// The same for a file. Never blocks: a FIFO would delay all other channels and the daemon's end.
std::variant<double, ChannelFault> read_number_file(const std::string& path, FileWriting& writing);

}  // namespace ifog
