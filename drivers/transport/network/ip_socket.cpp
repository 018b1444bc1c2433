// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/network/ip_socket.h"

#include <arpa/inet.h>
#include <net/if.h>
#include <netinet/in.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "drivers/transport/transport.h"

namespace ifog {
namespace {

// sockaddr_storage can hold any address.
template <typename Address>
Address as(const sockaddr_storage& storage) {
  Address out{};
  std::memcpy(&out, &storage, sizeof out);
  return out;
}

template <typename Address>
sockaddr_storage stored(const Address& address) {
  sockaddr_storage out{};
  std::memcpy(&out, &address, sizeof address);
  return out;
}

}  // namespace

std::optional<IpAddress> IpAddress::parse(const std::string& text) {
  IpAddress out;
  sockaddr_in v4{};
  v4.sin_family = AF_INET;
  if (inet_pton(AF_INET, text.c_str(), &v4.sin_addr) == 1) {
    out.address_ = stored(v4);
    return out;
  }
  const std::size_t percent = text.find('%');
  sockaddr_in6 v6{};
  v6.sin6_family = AF_INET6;
  if (inet_pton(AF_INET6, text.substr(0, percent).c_str(), &v6.sin6_addr) != 1) return std::nullopt;
  if (percent != std::string::npos) {
    out.interface_ = text.substr(percent + 1);
    if (out.interface_.empty() || out.interface_.size() >= IFNAMSIZ) return std::nullopt;
  }
  out.address_ = stored(v6);
  return out;
}

bool IpAddress::is_multicast() const {
  if (!is_v6()) return IN_MULTICAST(ntohl(as<sockaddr_in>(address_).sin_addr.s_addr));
  const auto v6 = as<sockaddr_in6>(address_);
  return IN6_IS_ADDR_MULTICAST(&v6.sin6_addr);
}

bool IpAddress::is_link_local_v6() const {
  if (!is_v6()) return false;
  const auto v6 = as<sockaddr_in6>(address_);
  return IN6_IS_ADDR_LINKLOCAL(&v6.sin6_addr);
}

std::optional<sockaddr_storage> IpAddress::at_port(std::uint16_t port, const std::string& interface,
                                                   socklen_t& size) const {
  if (!is_v6()) {
    auto v4 = as<sockaddr_in>(address_);
    v4.sin_port = htons(port);
    size = sizeof v4;
    return stored(v4);
  }
  auto v6 = as<sockaddr_in6>(address_);
  v6.sin6_port = htons(port);
  size = sizeof v6;
  const std::string& name = interface.empty() ? interface_ : interface;
  if (!name.empty()) {
    v6.sin6_scope_id = if_nametoindex(name.c_str());
    if (v6.sin6_scope_id == 0) return std::nullopt;
  }
  return stored(v6);
}

bool IpAddress::is_host_of(const sockaddr_storage& sender) const noexcept {
  if (sender.ss_family != address_.ss_family) return false;
  if (!is_v6()) return as<sockaddr_in>(sender).sin_addr.s_addr == as<sockaddr_in>(address_).sin_addr.s_addr;
  const auto theirs = as<sockaddr_in6>(sender), ours = as<sockaddr_in6>(address_);
  return std::memcmp(&theirs.sin6_addr, &ours.sin6_addr, sizeof ours.sin6_addr) == 0;
}

std::string host_and_port(const std::string& host, std::uint16_t port) {
  const bool v6 = host.find(':') != std::string::npos;
  return (v6 ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

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
