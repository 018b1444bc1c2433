// SPDX-License-Identifier: Apache-2.0
// SocketCAN raw sockets: opening, and conversion of frames.
#pragma once

#include <linux/can.h>

#include <cstddef>
#include <span>
#include <string>

#include "drivers/ifog/driver.h"
#include "drivers/system/fd.h"
#include "drivers/transport/transport.h"

namespace ifog {

// A non-blocking raw socket with CAN FD, bound to an interface that is up.
class CanSocket {
 public:
  CanSocket() = default;
  // Throws OpenError: no CAN in the kernel, no such interface, not a CAN interface, down.
  explicit CanSocket(const std::string& interface);
  void close() noexcept { fd_.close(); }

  [[nodiscard]] int fd() const { return fd_; }

  // Receives only data frames of these ids (all if empty) and every error frame. Throws OpenError.
  void receive_only(std::span<const CanId> ids, const std::string& interface) const;
  void receive_nothing() const noexcept;

 private:
  Fd fd_;
};

enum class CanKind { data, remote, error, unknown };

// size: returned by the socket; it distinguishes classical from FD frames. Sets all but arrival_ns.
CanKind from_socket(const canfd_frame& in, std::size_t size, ifog_can_frame& out) noexcept;

// Returns the size to send. An FD length without a DLC is zero-padded to the next one.
std::size_t to_socket(const ifog_can_frame& in, canfd_frame& out) noexcept;

}  // namespace ifog
