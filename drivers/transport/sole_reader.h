// SPDX-License-Identifier: Apache-2.0
// A FIFO or a serial line gives each byte to one reader: a second process at it would leave both with half.
#pragma once

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

  // Claims what `fd` has open, which may be what is held already. Throws DeviceTaken, and holds what it held.
  void take(int fd, const std::string& device);
  // For a child, too, that has inherited the descriptor.
  void release() noexcept;

 private:
  int held_ = -1;  // a descriptor of its own of what was opened first
};

}  // namespace ifog
