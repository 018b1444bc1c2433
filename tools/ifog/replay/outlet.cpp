// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/replay/outlet.h"

#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <system_error>

#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/interrupt.h"

namespace ifog::tools {
namespace {

constexpr int kPatience_ms = 100;  // between checks for an interrupt

}  // namespace

ssize_t Outlet::write(const void* bytes, std::size_t n) { return ::write(fd_, bytes, n); }

void Outlet::pause(int error) {
  if (error == ENOBUFS) {
    // poll() does not see a full queue of a CAN interface: wait for about one frame at 1 Mbit/s.
    const timespec frame{0, 100'000};
    nanosleep(&frame, nullptr);
    return;
  }
  pollfd ask{fd_, POLLOUT, 0};
  poll(&ask, 1, kPatience_ms);
}

bool Outlet::send(const void* bytes, std::size_t n, bool whole) {
  const auto* at = static_cast<const unsigned char*>(bytes);
  while (n > 0) {
    const ssize_t accepted = write(at, n);
    // Part of a datagram is a different datagram; a second write cannot repair that.
    if (whole && accepted > 0 && static_cast<std::size_t>(accepted) != n)
      throw refusal("{}: cannot send: {} of {} bytes of a frame were accepted", name_, accepted, n);
    if (accepted > 0) {
      at += accepted;
      n -= static_cast<std::size_t>(accepted);
      if (n > 0) ++retries_;
      continue;
    }
    const int error = accepted < 0 ? errno : EAGAIN;
    if (interrupted()) return false;
    // Of an earlier datagram that nobody received; a sensor goes on sending.
    if (whole && error == ECONNREFUSED) continue;
    if (error == EINTR) continue;
    if (error == EPIPE) throw refusal("{}: the reader went away", name_);
    if (error != EAGAIN && error != ENOBUFS)
      throw refusal("{}: cannot send: {}", name_, std::generic_category().message(error));
    ++retries_;
    pause(error);
  }
  return true;
}

}  // namespace ifog::tools
