// SPDX-License-Identifier: Apache-2.0
// A FIFO or a serial line gives each byte to one reader: a second process at it would leave both with half.
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>

#include "drivers/transport/transport.h"

namespace ifog {

// Another process has said that it reads the device.
struct DeviceTaken : OpenError {
  explicit DeviceTaken(const std::string& device);
};

// Says so of what `fd` has open, for as long as it is open. Throws DeviceTaken.
void claim(int fd, const std::string& device);

// Says so of what is open, until it is released, however often it is opened meanwhile: between two openings
// nobody else gets in. What many may read, and a file system that knows no locks, is left as it is.
class SoleReader {
 public:
  SoleReader() = default;
  ~SoleReader() { release(); }
  SoleReader(const SoleReader&) = delete;
  SoleReader& operator=(const SoleReader&) = delete;

  // Of what `fd` has open, which may be what is held already. Throws DeviceTaken, and holds what it held.
  void take(int fd, const std::string& device);
  // For a child, too, that has inherited the descriptor.
  void release() noexcept;

 private:
  int held_ = -1;  // a descriptor of its own of what was opened first
};

inline DeviceTaken::DeviceTaken(const std::string& device)
    : OpenError(device, "another process reads it", EBUSY, "a device or FIFO of this daemon's own") {}

inline void claim(int fd, const std::string& device) {
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) throw DeviceTaken(device);
}

inline void SoleReader::take(int fd, const std::string& device) {
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

inline void SoleReader::release() noexcept {
  if (held_ < 0) return;
  ::flock(held_, LOCK_UN);
  ::close(held_);
  held_ = -1;
}

}  // namespace ifog
