// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/sole_reader.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace ifog {

DeviceInUse::DeviceInUse(const std::string& device)
    : OpenError(device, "another process reads it", EBUSY, "a device or FIFO of this daemon's own") {}

void claim(int fd, const std::string& device) {
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) throw DeviceInUse(device);
}

void SoleReader::take(int fd, const std::string& device) {
  struct stat info {
  }, held{};
  if (::fstat(fd, &info) != 0 || !(S_ISFIFO(info.st_mode) || ::isatty(fd) == 1)) return release();
  if (held_ >= 0 && ::fstat(held_, &held) == 0 && held.st_dev == info.st_dev && held.st_ino == info.st_ino)
    return;
  claim(fd, device);
  const int own = ::fcntl(fd, F_DUPFD_CLOEXEC, 0);
  release();
  held_ = own;
}

void SoleReader::release() noexcept {
  if (held_ < 0) return;
  ::flock(held_, LOCK_UN);
  ::close(held_);
  held_ = -1;
}

}  // namespace ifog
