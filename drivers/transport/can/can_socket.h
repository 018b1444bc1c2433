// SPDX-License-Identifier: Apache-2.0
// SocketCAN raw sockets: opening, and the two forms of a frame.
#pragma once

#include <linux/can.h>

#include <cstddef>
#include <span>
#include <string>

#include "drivers/ifog/driver.h"
#include "drivers/transport/transport.h"

namespace ifog {

// A non-blocking raw socket bound to an interface that is up, able to carry CAN FD. Owns it.
class CanSocket {
 public:
  CanSocket() = default;
  // Throws OpenError: no CAN in the kernel, no such interface, none that carries CAN, down.
  explicit CanSocket(const std::string& interface);
  ~CanSocket() { close(); }
  CanSocket(const CanSocket&) = delete;
  CanSocket& operator=(const CanSocket&) = delete;
  CanSocket(CanSocket&& other) noexcept;
  CanSocket& operator=(CanSocket&& other) noexcept;
  void close() noexcept;

  [[nodiscard]] int fd() const { return fd_; }
  [[nodiscard]] bool is_open() const { return fd_ >= 0; }

  // Only data frames of these ids (all, when empty), and every error frame. Throws OpenError.
  void receive_only(std::span<const CanId> ids, const std::string& interface) const;
  void receive_nothing() const noexcept;

 private:
  int fd_ = -1;
};

enum class CanKind { data, remote, error, unknown };

// `size` is what the socket returned: it tells classical frames from FD ones. Sets all but arrival_ns.
CanKind from_socket(const canfd_frame& in, std::size_t size, ifog_can_frame& out) noexcept;

// Returns the size to be sent. An FD length that no DLC stands for is padded with zeros to the next that one
// does.
std::size_t to_socket(const ifog_can_frame& in, canfd_frame& out) noexcept;

}  // namespace ifog
