// SPDX-License-Identifier: Apache-2.0
// The sensor's end of a network line, on this computer's loopback.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "drivers/transport/network/udp.h"
#include "tests/unit/test.h"

namespace ifog {

// A socket bound to a port of the loopback that the system picks, IPv4 or IPv6.
class LoopbackSocket {
 public:
  LoopbackSocket(int family, int type) : family_(family), fd_(socket(family, type | SOCK_CLOEXEC, 0)) {}
  ~LoopbackSocket() {
    if (fd_ >= 0) close(fd_);
  }
  LoopbackSocket(const LoopbackSocket&) = delete;
  LoopbackSocket& operator=(const LoopbackSocket&) = delete;

  [[nodiscard]] int fd() const { return fd_; }
  // Port 0: any free one.
  bool bind(std::uint16_t port, const char* v4 = "127.0.0.1") {
    const int on = 1;
    setsockopt(fd_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    socklen_t size = 0;
    const sockaddr_storage address = at(port, v4, size);
    return ::bind(fd_, reinterpret_cast<const sockaddr*>(&address), size) == 0;
  }
  [[nodiscard]] std::uint16_t port() const {
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &size);
    in_port_t port = 0;  // at the same place in both kinds of address
    std::memcpy(&port, reinterpret_cast<const char*>(&address) + offsetof(sockaddr_in, sin_port),
                sizeof port);
    return ntohs(port);
  }
  void send_to(std::uint16_t port, const std::string& datagram, const char* v4 = "127.0.0.1") const {
    socklen_t size = 0;
    const sockaddr_storage address = at(port, v4, size);
    ASSERT_EQ(
        sendto(fd_, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&address), size),
        static_cast<ssize_t>(datagram.size()));
  }

 private:
  [[nodiscard]] sockaddr_storage at(std::uint16_t port, const char* v4, socklen_t& size) const {
    sockaddr_storage out{};
    if (family_ == AF_INET) {
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_port = htons(port);
      inet_pton(AF_INET, v4, &address.sin_addr);
      size = sizeof address;
      std::memcpy(&out, &address, size);
    } else {
      sockaddr_in6 address{};
      address.sin6_family = AF_INET6;
      address.sin6_port = htons(port);
      address.sin6_addr = in6addr_loopback;
      size = sizeof address;
      std::memcpy(&out, &address, size);
    }
    return out;
  }

  int family_, fd_;
};

// Of IPv4 and of IPv6, where the loopback has that.
class BothFamilies : public testing::TestWithParam<int> {
 public:
  static std::string name(const testing::TestParamInfo<int>& family) {
    return family.param == AF_INET ? "IPv4" : "IPv6";
  }

 protected:
  void SetUp() override {
    LoopbackSocket probe(GetParam(), SOCK_DGRAM);
    if (probe.fd() < 0 || !probe.bind(0))
      GTEST_SKIP() << "the loopback has no IPv6 here; sysctl net.ipv6.conf.lo.disable_ipv6=0 gives it one";
  }
  static const char* address() { return GetParam() == AF_INET ? "127.0.0.1" : "::1"; }
};

// A port that was free a moment ago.
inline std::uint16_t free_port(int family, int type) {
  LoopbackSocket probe(family, type);
  EXPECT_TRUE(probe.bind(0));
  return probe.port();
}

// Datagrams to a port of IPv4's loopback address.
inline UdpSettings on_loopback(std::uint16_t port) {
  UdpSettings settings;
  settings.port = port;
  settings.bind = "127.0.0.1";
  return settings;
}

}  // namespace ifog
