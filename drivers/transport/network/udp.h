// SPDX-License-Identifier: Apache-2.0
// UDP transport: datagrams of a sensor or serial server to a port of this computer or a multicast group.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "drivers/transport/transport.h"

namespace ifog {

// Addresses are numeric, IPv4 or IPv6.
struct UdpSettings {
  std::uint16_t port = 0;  // of this computer; the sensor sends to it
  // Local address to listen on; empty: all, of IPv6 if `host` is, else of IPv4.
  std::string bind;
  std::string group;      // multicast group instead of `bind`
  std::string interface;  // required with `group`: where it is joined
  // Only datagrams from here are accepted; others are counted. Opening bytes are sent here. Empty: from
  // anywhere, and no opening bytes.
  std::string host;
  // Port of the host's datagrams and for opening bytes. 0: port of the first sender, until it is silent for
  // two seconds; opening bytes go to `port`.
  std::uint16_t host_port = 0;
  // Receive buffer as the kernel counts it. Exceeding net.core.rmem_max needs CAP_NET_ADMIN, else there is a
  // warning.
  std::uint32_t receive_buffer_bytes = 1U << 20U;

  bool operator==(const UdpSettings&) const = default;
};

// "" or the error in the settings: key, value and what was expected.
std::string udp_complaint(const UdpSettings& settings);

// A delivery is one datagram with the kernel's arrival time. Kernel drops are counted by SO_RXQ_OVFL. Reopens
// if its address or the group's interface disappears and returns. Throws std::runtime_error for settings with
// a udp_complaint().
std::unique_ptr<Transport> make_udp_transport(const UdpSettings& settings);

}  // namespace ifog
