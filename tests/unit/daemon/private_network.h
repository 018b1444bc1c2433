// SPDX-License-Identifier: Apache-2.0
// LCM is multicast: a test that uses it moves into a network namespace of its own, so that nothing leaves the
// machine.
#pragma once

#include <arpa/inet.h>
#include <net/if.h>
#include <net/route.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/unit/test.h"

namespace ifog {

// Moves the process there, loopback up and multicast routed to it, as
// `ip link set lo up multicast on; ip route add 224.0.0.0/4 dev lo`. "" or why it could not.
inline std::string enter_private_network() {
  if (unshare(CLONE_NEWNET) != 0 && unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0)
    return std::string("unshare: ") + std::strerror(errno);
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  ifreq request{};
  std::strcpy(request.ifr_name, "lo");
  request.ifr_flags = IFF_UP | IFF_MULTICAST;
  std::string why;
  if (ioctl(fd, SIOCSIFFLAGS, &request) != 0) why = std::string("lo up: ") + std::strerror(errno);
  rtentry route{};
  char device[] = "lo";
  route.rt_dev = device;
  route.rt_flags = RTF_UP;
  const auto address = [](sockaddr& out, const char* text) {
    sockaddr_in in{};
    in.sin_family = AF_INET;
    inet_pton(AF_INET, text, &in.sin_addr);
    std::memcpy(&out, &in, sizeof in);
  };
  address(route.rt_dst, "224.0.0.0");
  address(route.rt_genmask, "240.0.0.0");
  if (why.empty() && ioctl(fd, SIOCADDRT, &route) != 0) why = std::string("route: ") + std::strerror(errno);
  close(fd);
  return why;
}

}  // namespace ifog
