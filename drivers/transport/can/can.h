// SPDX-License-Identifier: Apache-2.0
// The CAN transport, on SocketCAN raw sockets. Opens the interface again whenever it goes down or away.
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
  // Room for frames that wait for the reader, as the kernel counts them (some 700 bytes a classical frame).
  // What net.core.rmem_max forbids needs CAP_NET_ADMIN, else it is a warning.
  std::uint32_t receive_buffer_bytes = 4U << 20U;
};

// Arrival times are the kernel's (SO_TIMESTAMPING, software; else SO_TIMESTAMPNS; else a warning and the
// moment of the read). Frames the socket had no room for are kernel drops (SO_RXQ_OVFL, and SO_MEMINFO after
// the last frame). Frames that wait in the socket when the interface goes down or away are read all the same.
// A plugin's opening bytes have no place on a bus: open() refuses them.
std::unique_ptr<Transport> make_can_transport(const CanSettings& settings);

}  // namespace ifog
