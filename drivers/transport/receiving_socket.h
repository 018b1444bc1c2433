// SPDX-License-Identifier: Apache-2.0
// Options of a receiving socket (buffer size, arrival times, count of drops), and the kernel's data for each
// packet. For CAN, UDP and TCP.
#pragma once

#include <sys/socket.h>

#include <cstddef>
#include <cstdint>
#include <ctime>
#include <string>

#include <linux/errqueue.h>

namespace ifog {

// Space in a msghdr for the time stamp and the drop counter.
struct ControlRoom {
  alignas(cmsghdr) unsigned char bytes[CMSG_SPACE(sizeof(scm_timestamping)) + CMSG_SPACE(sizeof(unsigned))];
};

struct ReceiveControl {
  std::int64_t arrival_ns = 0;  // CLOCK_REALTIME; 0: none
  bool has_drops = false;
  std::uint32_t drops = 0;  // since the socket was opened, modulo 2^32
};

// message: as filled by recvmsg.
ReceiveControl receive_control(const msghdr& message) noexcept;

// Sets the receive buffer, as the kernel counts it. Exceeding net.core.rmem_max needs CAP_NET_ADMIN; if less
// than `wanted` is granted this is added to `warning`, with the device's `name`.
void ask_for_room(int fd, std::size_t wanted, const std::string& name, std::string& warning);
// Requests the kernel's arrival time for each packet (SO_TIMESTAMPING, software); failure is added to
// `warning`.
void ask_for_times(int fd, const std::string& name, std::string& warning);
// Requests the number of dropped packets with each packet (SO_RXQ_OVFL).
void ask_for_drops(int fd) noexcept;

}  // namespace ifog
