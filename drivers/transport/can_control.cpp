#include "drivers/transport/can_control.h"

#include <linux/errqueue.h>

#include <cstring>
#include <ctime>

namespace ifog {
namespace {

std::int64_t ns(const timespec& t) { return static_cast<std::int64_t>(t.tv_sec) * 1'000'000'000 + t.tv_nsec; }

}  // namespace

CanControl can_control(const msghdr& message) noexcept {
  CanControl said;
  auto* where = const_cast<msghdr*>(&message);
  for (cmsghdr* c = CMSG_FIRSTHDR(where); c != nullptr; c = CMSG_NXTHDR(where, c)) {
    if (c->cmsg_level != SOL_SOCKET) continue;
    if (c->cmsg_type == SCM_TIMESTAMPING && c->cmsg_len >= CMSG_LEN(sizeof(scm_timestamping))) {
      scm_timestamping stamps{};
      std::memcpy(&stamps, CMSG_DATA(c), sizeof stamps);
      said.arrival_ns = ns(stamps.ts[0]);  // [0] is software; [2], hardware, runs on a clock of its own
    } else if (c->cmsg_type == SCM_TIMESTAMPNS && c->cmsg_len >= CMSG_LEN(sizeof(timespec))) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
      said.arrival_ns = ns(stamp);
    } else if (c->cmsg_type == SO_RXQ_OVFL && c->cmsg_len >= CMSG_LEN(sizeof said.drops)) {
      std::memcpy(&said.drops, CMSG_DATA(c), sizeof said.drops);
      said.has_drops = true;
    }
  }
  return said;
}

}  // namespace ifog
