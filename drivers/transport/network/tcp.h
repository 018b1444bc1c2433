// SPDX-License-Identifier: Apache-2.0
// TCP transport: connects to a listening sensor or serial server, and reconnects after a loss.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "drivers/transport/transport.h"

namespace ifog {

struct TcpSettings {
  std::string host;  // numeric IPv4 or IPv6 address; a link-local one with its interface, fe80::20%eth0
  std::uint16_t port = 0;

  bool operator==(const TcpSettings&) const = default;
};

// "" or the error in the settings: key, value and what was expected.
std::string tcp_complaint(const TcpSettings& settings);

// Arrival times are the kernel's, of the last byte read. A connection is lost if the other end closes it or
// answers no probe for three seconds (cable, power). An attempt to connect ends after 0.5 s, so that a
// returning device is used within a second. No bytes are lost: the sender keeps what the kernel has no space
// for. Throws std::runtime_error for settings with a tcp_complaint().
std::unique_ptr<Transport> make_tcp_transport(const TcpSettings& settings);

}  // namespace ifog
