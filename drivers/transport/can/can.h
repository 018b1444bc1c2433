// SPDX-License-Identifier: Apache-2.0
// CAN transport on SocketCAN raw sockets. Reopens the interface if it goes down or disappears.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "drivers/transport/transport.h"

namespace ifog {

struct CanSettings {
  std::string interface;   // can0
  std::vector<CanId> ids;  // filtered in the kernel; empty: all
  // Receive buffer as the kernel counts it (some 700 bytes per classical frame). Exceeding net.core.rmem_max
  // needs CAP_NET_ADMIN, else there is a warning.
  std::uint32_t receive_buffer_bytes = 4U << 20U;
};

// Arrival times are the kernel's (SO_TIMESTAMPING, software; else the read time with a warning). Kernel drops
// are counted by SO_RXQ_OVFL, and by SO_MEMINFO after the last frame. Frames in the socket are still read
// after the interface goes down. open() rejects opening bytes, which a bus cannot use.
std::unique_ptr<Transport> make_can_transport(const CanSettings& settings);

}  // namespace ifog
