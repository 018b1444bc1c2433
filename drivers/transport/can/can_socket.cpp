// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/can/can_socket.h"

#include <fcntl.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

namespace ifog {
namespace {

constexpr std::array<std::uint8_t, 7> kFdLengths{12, 16, 20, 24, 32, 48, 64};  // ISO 11898-1, above 8

template <class Value>
bool set_raw(int fd, int option, const Value& value) {
  return setsockopt(fd, SOL_CAN_RAW, option, &value, sizeof value) == 0;
}

// Checks the interface before binding; returns its index.
int checked_interface(int fd, const std::string& interface) {
  ifreq request{};
  if (interface.empty() || interface.size() >= IFNAMSIZ)
    throw OpenError(interface.empty() ? "can transport" : interface, "no interface name", EINVAL,
                    "one of 1 to 15 letters, such as can0");
  interface.copy(request.ifr_name, interface.size());
  const auto ask = [&](unsigned long what) {
    if (ioctl(fd, what, &request) != 0)
      throw OpenError(interface, "cannot open", errno, "a CAN interface (ip link show type can)");
  };
  ask(SIOCGIFHWADDR);
  if (request.ifr_hwaddr.sa_family != ARPHRD_CAN)
    throw OpenError(interface, "cannot open", EPROTOTYPE, "a CAN interface, this one carries no CAN");
  ask(SIOCGIFFLAGS);
  // Binding would succeed, but nothing would arrive.
  if ((request.ifr_flags & IFF_UP) == 0)
    throw OpenError(interface, "cannot open", ENETDOWN,
                    "the interface up (ip link set " + interface + " up)");
  ask(SIOCGIFINDEX);
  return request.ifr_ifindex;
}

}  // namespace

CanSocket::CanSocket(const std::string& interface)
    : fd_(socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW)) {
  if (fd_ < 0)
    throw OpenError(interface, "cannot open a CAN socket", errno,
                    "a kernel with the modules can and can-raw");
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = checked_interface(fd_, interface);
  const int on = 1;
  if (!set_raw(fd_, CAN_RAW_FD_FRAMES, on))
    throw OpenError(interface, "cannot receive CAN FD", errno, "a kernel of 3.6 or later");
  if (bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    throw OpenError(interface, "cannot bind", errno, "a CAN interface that is up");
}

void CanSocket::receive_only(std::span<const CanId> ids, const std::string& interface) const {
  std::vector<can_filter> filters;
  // Remote frames carry no data and are not needed.
  for (const CanId& id : ids)
    filters.push_back({id.extended ? id.id | CAN_EFF_FLAG : id.id,
                       (id.extended ? CAN_EFF_MASK : CAN_SFF_MASK) | CAN_EFF_FLAG | CAN_RTR_FLAG});
  if (ids.empty()) filters.push_back({0, CAN_RTR_FLAG});
  const auto bytes = static_cast<socklen_t>(filters.size() * sizeof(can_filter));
  if (setsockopt(fd_, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(), bytes) != 0)
    throw OpenError(interface, "cannot set " + std::to_string(filters.size()) + " filters", errno,
                    "at most 512");
  const can_err_mask_t errors = CAN_ERR_MASK;
  if (!set_raw(fd_, CAN_RAW_ERR_FILTER, errors))
    throw OpenError(interface, "cannot ask for error frames", errno, "a SocketCAN interface");
}

void CanSocket::receive_nothing() const noexcept { setsockopt(fd_, SOL_CAN_RAW, CAN_RAW_FILTER, nullptr, 0); }

CanKind from_socket(const canfd_frame& in, std::size_t size, ifog_can_frame& out) noexcept {
  if (size != CAN_MTU && size != CANFD_MTU) return CanKind::unknown;
  if ((in.can_id & CAN_ERR_FLAG) != 0) return CanKind::error;
  if ((in.can_id & CAN_RTR_FLAG) != 0) return CanKind::remote;
  const bool extended = (in.can_id & CAN_EFF_FLAG) != 0, fd = size == CANFD_MTU;
  out.id = in.can_id & (extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  out.flags = static_cast<std::uint8_t>((extended ? IFOG_CAN_EXTENDED : 0) | (fd ? IFOG_CAN_FD : 0) |
                                        (fd && (in.flags & CANFD_BRS) != 0 ? IFOG_CAN_BRS : 0));
  out.length = std::min<std::uint8_t>(in.len, fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN);
  std::memcpy(out.data, in.data, out.length);
  std::memset(out.data + out.length, 0, sizeof out.data - out.length);
  return CanKind::data;
}

std::size_t to_socket(const ifog_can_frame& in, canfd_frame& out) noexcept {
  const bool extended = (in.flags & IFOG_CAN_EXTENDED) != 0, fd = (in.flags & IFOG_CAN_FD) != 0;
  out = canfd_frame{};
  out.can_id = extended ? (in.id & CAN_EFF_MASK) | CAN_EFF_FLAG : in.id & CAN_SFF_MASK;
  const auto length = std::min<std::uint8_t>(in.length, fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN);
  std::memcpy(out.data, in.data, length);
  out.len = length > CAN_MAX_DLEN ? *std::ranges::lower_bound(kFdLengths, length) : length;
  if (fd && (in.flags & IFOG_CAN_BRS) != 0) out.flags = CANFD_BRS;
  return fd ? CANFD_MTU : CAN_MTU;
}

}  // namespace ifog
