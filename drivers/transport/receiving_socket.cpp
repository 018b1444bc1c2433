// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/receiving_socket.h"

#include <linux/net_tstamp.h>

#include <cerrno>
#include <cstring>
#include <system_error>

namespace ifog {
namespace {

std::int64_t ns(const timespec& t) { return static_cast<std::int64_t>(t.tv_sec) * 1'000'000'000 + t.tv_nsec; }

bool set(int fd, int option, int value) {
  return setsockopt(fd, SOL_SOCKET, option, &value, sizeof value) == 0;
}

void warn(std::string& warning, const std::string& name, const std::string& what) {
  warning += (warning.empty() ? name + ": " : "; ") + what;
}

}  // namespace

ReceiveControl receive_control(const msghdr& message) noexcept {
  ReceiveControl said;
  auto* where = const_cast<msghdr*>(&message);
  for (cmsghdr* c = CMSG_FIRSTHDR(where); c != nullptr; c = CMSG_NXTHDR(where, c)) {
    if (c->cmsg_level != SOL_SOCKET) continue;
    if (c->cmsg_type == SCM_TIMESTAMPING && c->cmsg_len >= CMSG_LEN(sizeof(scm_timestamping))) {
      scm_timestamping stamps{};
      std::memcpy(&stamps, CMSG_DATA(c), sizeof stamps);
      said.arrival_ns = ns(stamps.ts[0]);  // [0] is software; [2], hardware, has its own clock
    } else if (c->cmsg_type == SO_RXQ_OVFL && c->cmsg_len >= CMSG_LEN(sizeof said.drops)) {
      std::memcpy(&said.drops, CMSG_DATA(c), sizeof said.drops);
      said.has_drops = true;
    }
  }
  return said;
}

void ask_for_room(int fd, std::size_t wanted, const std::string& name, std::string& warning) {
  const auto bytes = static_cast<int>(wanted);
  if (bytes == 0 || set(fd, SO_RCVBUFFORCE, bytes)) return;
  set(fd, SO_RCVBUF, bytes);
  int got = 0;
  socklen_t size = sizeof got;
  // The kernel doubles the requested size.
  if (getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &got, &size) != 0 || got / 2 < bytes)
    warn(warning, name,
         "receive buffer of " + std::to_string(got / 2) + " bytes instead of " + std::to_string(bytes) +
             " (net.core.rmem_max)");
}

void ask_for_times(int fd, const std::string& name, std::string& warning) {
  if (set(fd, SO_TIMESTAMPING, SOF_TIMESTAMPING_RX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE)) return;
  warn(warning, name,
       "no time stamps from the kernel (" + std::generic_category().message(errno) +
           "): arrival times are those of the reading");
}

void ask_for_drops(int fd) noexcept { set(fd, SO_RXQ_OVFL, 1); }

}  // namespace ifog
