// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/network/ip_socket.h"

#include <unistd.h>

#include <cerrno>
#include <utility>

#include "drivers/transport/transport.h"

namespace ifog {

IpSocket::IpSocket(int family, int type, const std::string& name)
    : fd_(socket(family, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  if (fd_ < 0) throw OpenError(name, "cannot open a socket", errno, "a kernel and a unit that allow it");
}

IpSocket IpSocket::accepted(const IpSocket& listener) noexcept {
  IpSocket out;
  out.fd_ = Fd(accept4(listener.fd_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  return out;
}

int IpSocket::set(int level, int option, int value) const noexcept {
  return setsockopt(fd_, level, option, &value, sizeof value) == 0 ? 0 : errno;
}

int IpSocket::bind(const sockaddr_storage& address, socklen_t size) const noexcept {
  return ::bind(fd_, reinterpret_cast<const sockaddr*>(&address), size) == 0 ? 0 : errno;
}

int IpSocket::connect(const sockaddr_storage& address, socklen_t size) const noexcept {
  return ::connect(fd_, reinterpret_cast<const sockaddr*>(&address), size) == 0 ? 0 : errno;
}

}  // namespace ifog
