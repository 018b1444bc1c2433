// SPDX-License-Identifier: Apache-2.0
// Numeric IPv4 and IPv6 addresses. Names are never looked up: a name server that does not answer would hold
// up a thread that has a sensor to read.
#pragma once

#include <sys/socket.h>

#include <cstdint>
#include <optional>
#include <string>

namespace ifog {

class IpAddress {
 public:
  // "192.168.1.20", "fd00::20" or, with the interface it is reached by, "fe80::20%eth0". nullopt: none.
  static std::optional<IpAddress> parse(const std::string& text);

  [[nodiscard]] bool is_v6() const { return address_.ss_family == AF_INET6; }
  [[nodiscard]] int family() const { return address_.ss_family; }
  [[nodiscard]] bool is_multicast() const;
  [[nodiscard]] bool is_link_local_v6() const;
  [[nodiscard]] const std::string& interface() const { return interface_; }  // "" for none

  // For bind and connect; `size` gets the length. The interface, "" for that of the address, is looked up
  // now: it may come and go. nullopt: there is none of that name.
  [[nodiscard]] std::optional<sockaddr_storage> at_port(std::uint16_t port, const std::string& interface,
                                                        socklen_t& size) const;
  // Whether `sender` is this host, whatever its port.
  [[nodiscard]] bool is_host_of(const sockaddr_storage& sender) const noexcept;

 private:
  sockaddr_storage address_{};
  std::string interface_;
};

// "192.168.1.20:4000", "[fd00::20]:4000".
std::string host_and_port(const std::string& host, std::uint16_t port);

}  // namespace ifog
