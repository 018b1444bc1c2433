// SPDX-License-Identifier: Apache-2.0
// The TCP transport: a sensor or a serial server that listens, to which this end connects. Connects again
// whenever the connection goes.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "drivers/transport/transport.h"

namespace ifog {

struct TcpSettings {
  std::string host;  // a numeric address, IPv4 or IPv6; a link-local one with its interface, fe80::20%eth0
  std::uint16_t port = 0;

  bool operator==(const TcpSettings&) const = default;
};

// "" or what is wrong with the settings: the key, its value and what was expected.
std::string tcp_complaint(const TcpSettings& settings);

// Arrival times are the kernel's, of the last byte read. A connection is given up when the other end closes
// it or, cable pulled or power lost, answers no probe for three seconds; an attempt to connect after half a
// second, so that a device that comes back is in use within a second, however often it was asked in vain. No
// byte is lost on the way: what the kernel has no room for the sender keeps. Throws std::runtime_error on
// settings that tcp_complaint() finds wrong.
std::unique_ptr<Transport> make_tcp_transport(const TcpSettings& settings);

}  // namespace ifog
