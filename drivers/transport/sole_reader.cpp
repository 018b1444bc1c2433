// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/sole_reader.h"

#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace ifog {

DeviceTaken::DeviceTaken(const std::string& device)
    : OpenError(device, "another process reads it", EBUSY, "a device or FIFO of this daemon's own") {}

void read_alone(int fd, const std::string& device, int before) {
  struct stat info {};
  if (::fstat(fd, &info) != 0 || !(S_ISFIFO(info.st_mode) || ::isatty(fd) == 1)) return;
  if (before >= 0) ::flock(before, LOCK_UN);
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) throw DeviceTaken(device);
}

}  // namespace ifog
