// SPDX-License-Identifier: Apache-2.0
// What a socket that receives is asked for (room, arrival times, a count of what was dropped), and what the
// kernel then says with each packet. For CAN, UDP and TCP alike.
#pragma once

#include <sys/socket.h>

#include <cstddef>
#include <cstdint>
#include <ctime>
#include <string>

#include <linux/errqueue.h>

namespace ifog {

// Room in a msghdr for all that can be said: a time stamp of either kind and the drop counter.
struct ControlRoom {
  alignas(cmsghdr) unsigned char bytes[CMSG_SPACE(sizeof(scm_timestamping)) + CMSG_SPACE(sizeof(timespec)) +
                                       CMSG_SPACE(sizeof(std::uint32_t))];
};

struct ReceiveControl {
  std::int64_t arrival_ns = 0;  // CLOCK_REALTIME; 0: not said
  bool has_drops = false;
  std::uint32_t drops = 0;  // since the socket was opened, modulo 2^32
};

// `message` as recvmsg filled it.
ReceiveControl receive_control(const msghdr& message) noexcept;

// Room for what waits to be read, as the kernel counts it. What net.core.rmem_max forbids needs
// CAP_NET_ADMIN; less than `wanted` is added to `warning`. `name` is the device's, for that.
void ask_for_room(int fd, std::size_t wanted, const std::string& name, std::string& warning);
// The kernel's time of arrival with each packet (SO_TIMESTAMPING, software; else SO_TIMESTAMPNS); none is
// added to `warning`.
void ask_for_times(int fd, const std::string& name, std::string& warning);
// With each packet, how many before it found no room (SO_RXQ_OVFL).
void ask_for_drops(int fd) noexcept;

}  // namespace ifog
