// SPDX-License-Identifier: Apache-2.0
// The UDP transport: datagrams that a sensor or a serial server sends to a port of this computer, or to a
// multicast group.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "drivers/transport/transport.h"

namespace ifog {

// Addresses are numeric, IPv4 or IPv6.
struct UdpSettings {
  std::uint16_t port = 0;  // of this computer, to which the sensor sends
  // The address of this computer that is listened on; empty: all, of IPv6 where `host` is of it, else of
  // IPv4.
  std::string bind;
  std::string group;      // a multicast group in place of `bind`
  std::string interface;  // where the group is joined: required with it
  // Datagrams from elsewhere are dropped and counted. A driver's opening bytes go there, and without it
  // nowhere. Empty: from anywhere.
  std::string host;
  // The port that the host's datagrams come from, and opening bytes go to. 0: that of the first sender, until it has
  // been silent for two seconds; opening bytes go to `port`.
  std::uint16_t host_port = 0;
  // Room for what waits for the reader, as the kernel counts it. What net.core.rmem_max forbids needs
  // CAP_NET_ADMIN, else it is a warning.
  std::uint32_t receive_buffer_bytes = 1U << 20U;

  bool operator==(const UdpSettings&) const = default;
};

// "" or what is wrong with the settings: the key, its value and what was expected.
std::string udp_complaint(const UdpSettings& settings);

// Each delivery is one datagram with the kernel's time of its arrival; datagrams the socket had no room for
// are kernel drops (SO_RXQ_OVFL). Opens again when its address or the group's interface goes away and comes
// back. Throws std::runtime_error on settings that udp_complaint() finds wrong.
std::unique_ptr<Transport> make_udp_transport(const UdpSettings& settings);

}  // namespace ifog
