// SPDX-License-Identifier: Apache-2.0
// A UDP or TCP socket over IPv4 or IPv6, non-blocking.
#pragma once

#include <string>

#include "drivers/system/fd.h"
#include "drivers/transport/network/ip_address.h"

namespace ifog {

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
