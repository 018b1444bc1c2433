// SPDX-License-Identifier: Apache-2.0
// Numeric addresses, and UDP and TCP sockets, of IPv4 and IPv6.
#pragma once

#include <sys/socket.h>

#include <cstdint>
#include <optional>
#include <string>

#include "drivers/system/fd.h"

namespace ifog {

// Names are not resolved, because an unresponsive name server would block a reader thread.
class IpAddress {
 public:
  // "192.168.1.20", "fd00::20", or with its interface "fe80::20%eth0". nullopt: invalid.
  static std::optional<IpAddress> parse(const std::string& text);

  [[nodiscard]] bool is_v6() const { return address_.ss_family == AF_INET6; }
  [[nodiscard]] int family() const { return address_.ss_family; }
  [[nodiscard]] bool is_multicast() const;
  [[nodiscard]] bool is_link_local_v6() const;
  [[nodiscard]] const std::string& interface() const { return interface_; }  // "" if none

  // Address for bind and connect. interface: "" for that of the address; looked up now, as it may come and
  // go. nullopt: no such interface.
  [[nodiscard]] std::optional<sockaddr_storage> at_port(std::uint16_t port, const std::string& interface,
                                                        socklen_t& size) const;
  // True if `sender` is this host, with any port.
  [[nodiscard]] bool is_host_of(const sockaddr_storage& sender) const noexcept;

 private:
  sockaddr_storage address_{};
  std::string interface_;
};

// "192.168.1.20:4000", "[fd00::20]:4000".
std::string host_and_port(const std::string& host, std::uint16_t port);

// Non-blocking.
class IpSocket {
 public:
  IpSocket() = default;
  // type: SOCK_DGRAM or SOCK_STREAM. Throws OpenError with `name`.
  IpSocket(int family, int type, const std::string& name);
  // Next connection of a listening TCP socket; not open if there is none, with errno set.
  static IpSocket accepted(const IpSocket& listener) noexcept;
  void close() noexcept { fd_.close(); }

  [[nodiscard]] int fd() const { return fd_; }
  [[nodiscard]] bool is_open() const { return fd_ >= 0; }
  // 0 or errno.
  [[nodiscard]] int set(int level, int option, int value) const noexcept;
  [[nodiscard]] int bind(const sockaddr_storage& address, socklen_t size) const noexcept;
  [[nodiscard]] int connect(const sockaddr_storage& address, socklen_t size) const noexcept;

 private:
  Fd fd_;
};

}  // namespace ifog
