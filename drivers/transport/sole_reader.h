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

// Says so of what `fd` has open, for as long as it is open; `before`, −1 for none, had it in this process and
// gives it up. What many may read, and a file system that knows no locks, is left as it is. Throws
// DeviceTaken.
void read_alone(int fd, const std::string& device, int before = -1);

}  // namespace ifog
