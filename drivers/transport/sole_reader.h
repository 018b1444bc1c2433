// SPDX-License-Identifier: Apache-2.0
// Locks a FIFO or serial line for one reader: of two processes each would get a part of the bytes.
#pragma once

#include <string>

#include "drivers/transport/transport.h"

namespace ifog {

// Another process has locked the device.
struct DeviceInUse : OpenError {
  explicit DeviceInUse(const std::string& device);
};

// Locks what `fd` has open, for as long as it is open. Throws DeviceInUse.
void claim(int fd, const std::string& device);

// Keeps the lock until it is released, even if the device is closed and reopened. Devices with several
// readers, and file systems without locks, are not locked.
class SoleReader {
 public:
  SoleReader() = default;
  ~SoleReader() { release(); }
  SoleReader(const SoleReader&) = delete;
  SoleReader& operator=(const SoleReader&) = delete;

  // Locks what `fd` has open, possibly again. Throws DeviceInUse, keeping the previous lock.
  void take(int fd, const std::string& device);
  // Also valid for a child process that has inherited the descriptor.
  void release() noexcept;

 private:
  int held_ = -1;  // own descriptor of what was opened first
};

}  // namespace ifog
