// SPDX-License-Identifier: Apache-2.0
// A UDP or TCP socket over IPv4 or IPv6, non-blocking.
#pragma once

#include <unistd.h>

#include <cerrno>
#include <string>
#include <utility>

#include "drivers/transport/ip_address.h"
#include "drivers/transport/transport.h"

namespace ifog {

// Owns it.
class IpSocket {
 public:
  IpSocket() = default;
  // `type`: SOCK_DGRAM or SOCK_STREAM. Throws OpenError, which names `name`.
  IpSocket(int family, int type, const std::string& name);
  // Of a listening TCP socket, the next that connected; not open for none, errno then says why.
  static IpSocket accepted(const IpSocket& listener) noexcept;
  ~IpSocket() { close(); }
  IpSocket(const IpSocket&) = delete;
  IpSocket& operator=(const IpSocket&) = delete;
  IpSocket(IpSocket&& other) noexcept;
  IpSocket& operator=(IpSocket&& other) noexcept;
  void close() noexcept;

  [[nodiscard]] int fd() const { return fd_; }
  [[nodiscard]] bool is_open() const { return fd_ >= 0; }
  // 0, or errno.
  [[nodiscard]] int set(int level, int option, int value) const noexcept;
  [[nodiscard]] int bind(const sockaddr_storage& address, socklen_t size) const noexcept;
  [[nodiscard]] int connect(const sockaddr_storage& address, socklen_t size) const noexcept;

 private:
  int fd_ = -1;
};

inline IpSocket::IpSocket(int family, int type, const std::string& name)
    : fd_(socket(family, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  if (fd_ < 0) throw OpenError(name, "cannot open a socket", errno, "a kernel and a unit that allow it");
}

inline IpSocket IpSocket::accepted(const IpSocket& listener) noexcept {
  IpSocket out;
  out.fd_ = accept4(listener.fd_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  return out;
}

inline IpSocket::IpSocket(IpSocket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

inline IpSocket& IpSocket::operator=(IpSocket&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

inline void IpSocket::close() noexcept {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

inline int IpSocket::set(int level, int option, int value) const noexcept {
  return setsockopt(fd_, level, option, &value, sizeof value) == 0 ? 0 : errno;
}

inline int IpSocket::bind(const sockaddr_storage& address, socklen_t size) const noexcept {
  return ::bind(fd_, reinterpret_cast<const sockaddr*>(&address), size) == 0 ? 0 : errno;
}

inline int IpSocket::connect(const sockaddr_storage& address, socklen_t size) const noexcept {
  return ::connect(fd_, reinterpret_cast<const sockaddr*>(&address), size) == 0 ? 0 : errno;
}

}  // namespace ifog
