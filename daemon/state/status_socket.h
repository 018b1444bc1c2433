// SPDX-License-Identifier: Apache-2.0
// How `ifog status`, `adopt` and `revert` ask the daemon that works with a state folder: a socket in it. LCM knows no
// sender; here the kernel says at each end who is at the other.
//
// Who connects receives the status of every sensor, at once and each second, and may ask for a reload. Packets (SOCK_SEQPACKET)
// are a letter, and what the daemon's hold behind it:
//   from the daemon  S an encoded status_t; E all sensors have been; R a reload's complaints, nothing where it was done
//   to the daemon    R reload
#pragma once

#include <sys/types.h>

#include <list>
#include <string>
#include <vector>

namespace ifog {

enum class StatusPacket : char { status = 'S', end = 'E', reload = 'R' };
inline constexpr std::size_t kLongestStatusPacket = 1U << 17U;  // half of what a socket takes by default

class StatusSocket {
 public:
  StatusSocket() = default;
  ~StatusSocket();
  StatusSocket(const StatusSocket&) = delete;
  StatusSocket& operator=(const StatusSocket&) = delete;

  // By the process that holds the folder's mark. Gives a complaint, "" for none.
  [[nodiscard]] std::string open(const std::string& folder);
  // Encoded, of all sensors; those before are forgotten.
  void tell(std::vector<std::string> statuses);
  // Accepts, receives and sends what can be without waiting. True: somebody wants a reload.
  [[nodiscard]] bool serve();
  // To those who wanted it: what was refused, "" where all was done.
  void answer(const std::string& complaint);

 private:
  struct Client {
    int fd;
    bool asks = false;
    std::list<std::string> unsent{};
  };
  void accept_all();
  // False: it has gone.
  static bool receive(Client& client);
  static bool send(Client& client);
  void give_statuses(Client& client) const;

  int fd_ = -1;
  std::list<Client> clients_;
  std::vector<std::string> statuses_;
};

// A connection to the daemon with this number, which holds the folder's mark. Throws std::runtime_error with one line: no such
// socket, no right to it, another process at its other end.
[[nodiscard]] int connect_to_daemon(const std::string& folder, pid_t daemon);

}  // namespace ifog
