// SPDX-License-Identifier: Apache-2.0
// Options of a receiving socket (buffer size, arrival times, count of drops), and the kernel's data for each
// packet. For CAN, UDP and TCP.
#pragma once

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <string>

#include <linux/errqueue.h>

namespace ifog {

// Space in a msghdr for the time stamp and the drop counter.
struct ControlRoom {
  alignas(cmsghdr) unsigned char bytes[CMSG_SPACE(sizeof(scm_timestamping)) + CMSG_SPACE(sizeof(unsigned))];
};

struct ReceiveControl {
  std::int64_t arrival_ns = 0;  // CLOCK_REALTIME; 0: none
  bool has_drops = false;
  std::uint32_t drops = 0;  // since the socket was opened, modulo 2^32
};

// message: as filled by recvmsg.
ReceiveControl receive_control(const msghdr& message) noexcept;

// Sets the receive buffer, as the kernel counts it. Exceeding net.core.rmem_max needs CAP_NET_ADMIN; if less
// than `wanted` is granted this is added to `warning`, with the device's `name`.
void ask_for_room(int fd, std::size_t wanted, const std::string& name, std::string& warning);
// Requests the kernel's arrival time for each packet (SO_TIMESTAMPING, software); failure is added to
// `warning`.
void ask_for_times(int fd, const std::string& name, std::string& warning);
// Requests the number of dropped packets with each packet (SO_RXQ_OVFL).
void ask_for_drops(int fd) noexcept;

// Messages of one system call.
template <std::size_t kMost>
class ReceiveBatch {
 public:
  // Where message i goes, and its sender's address if that is wanted.
  void place(std::size_t i, const iovec& room, sockaddr_storage* sender = nullptr) noexcept {
    vectors_[i] = room;
    msghdr& header = messages_[i].msg_hdr;
    header.msg_iov = &vectors_[i];
    header.msg_iovlen = 1;
    header.msg_control = control_[i].bytes;
    header.msg_name = sender;
  }
  // Those that wait: their number, or −1 and errno.
  int receive(int fd) noexcept {
    // Resets the messages that the previous call used.
    for (std::size_t i = 0; i < filled_; ++i) {
      msghdr& header = messages_[i].msg_hdr;
      header.msg_namelen = header.msg_name == nullptr ? 0 : sizeof(sockaddr_storage);
      header.msg_controllen = sizeof(ControlRoom);
      header.msg_flags = 0;
    }
    const int n = recvmmsg(fd, messages_.data(), kMost, MSG_DONTWAIT, nullptr);
    // A failed message may be partly filled.
    filled_ = std::min(kMost, static_cast<std::size_t>(std::max(n, 0)) + 1);
    return n;
  }
  [[nodiscard]] std::size_t length(std::size_t i) const noexcept { return messages_[i].msg_len; }
  [[nodiscard]] ReceiveControl control(std::size_t i) const noexcept {
    return receive_control(messages_[i].msg_hdr);
  }

 private:
  std::size_t filled_ = kMost;  // number of messages to be prepared
  std::array<iovec, kMost> vectors_{};
  std::array<ControlRoom, kMost> control_{};
  std::array<mmsghdr, kMost> messages_{};
};

}  // namespace ifog
