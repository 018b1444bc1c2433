// What the kernel says beside each received CAN frame.
#pragma once

#include <sys/socket.h>

#include <cstdint>

namespace ifog {

struct CanControl {
  std::int64_t arrival_ns = 0;  // CLOCK_REALTIME; 0: not said
  bool has_drops = false;
  std::uint32_t drops = 0;  // since the socket was opened, modulo 2^32
};

// `message` as recvmsg filled it.
CanControl can_control(const msghdr& message) noexcept;

}  // namespace ifog
