// SPDX-License-Identifier: Apache-2.0
#include "daemon/state/status_socket.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "daemon/state/state_file.h"

namespace ifog {
namespace {

constexpr const char* kSocketName = "ifogd.socket";
constexpr std::size_t kMostClients = 16;

std::string socket_reason() { return std::generic_category().message(errno); }

// In the open folder, whose path may be longer than such an address holds.
sockaddr_un address_in(int folder) {
  sockaddr_un out{};
  out.sun_family = AF_UNIX;
  std::snprintf(out.sun_path, sizeof out.sun_path, "/proc/self/fd/%d/%s", folder, kSocketName);
  return out;
}

ucred peer_of(int fd) {
  ucred out{0, static_cast<uid_t>(-1), static_cast<gid_t>(-1)};
  socklen_t size = sizeof out;
  (void)::getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &out, &size);
  return out;
}

// Root, this user, and the group of the folder, which may put models into it.
bool may_ask(int fd) {
  const ucred peer = peer_of(fd);
  if (peer.uid == 0 || peer.uid == ::geteuid() || peer.gid == ::getegid()) return true;
  std::array<gid_t, 1024> groups{};
  socklen_t size = sizeof groups;
  if (::getsockopt(fd, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &size) != 0) return false;
  const gid_t* const end = groups.data() + size / sizeof groups[0];
  return std::find(static_cast<const gid_t*>(groups.data()), end, ::getegid()) != end;
}

std::string packet(StatusPacket kind, const std::string& content = "") {
  return static_cast<char>(kind) + content.substr(0, kLongestStatusPacket - 1);
}

}  // namespace

StatusSocket::~StatusSocket() {
  for (const Client& client : clients_) ::close(client.fd);
  if (fd_ >= 0) ::close(fd_);
}

std::string StatusSocket::open(const std::string& folder) {
  const Fd holder(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  fd_ = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  // That of a daemon that was killed, or what somebody put there: a name, which is never followed.
  (void)::unlinkat(holder, kSocketName, 0);
  const sockaddr_un address = address_in(holder);
  // Whatever the umask of the service: the group asks, too. Nobody else is at work yet.
  const mode_t before = ::umask(S_IXUSR | S_IXGRP | S_IRWXO);
  const bool bound = ::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  const int error = errno;
  ::umask(before);
  errno = error;
  if (bound && ::listen(fd_, static_cast<int>(kMostClients)) == 0) return "";
  return folder + "/" + kSocketName + ": ifog status and adopt cannot ask this daemon: " + socket_reason();
}

void StatusSocket::give_statuses(Client& client) const {
  // Who has not taken those of the last second yet gets none on top.
  if (statuses_.empty() || client.unsent.size() > 1) return;
  for (const std::string& status : statuses_) client.unsent.push_back(packet(StatusPacket::status, status));
  client.unsent.push_back(packet(StatusPacket::end));
}

void StatusSocket::tell(std::vector<std::string> statuses) {
  statuses_ = std::move(statuses);
  for (Client& client : clients_) give_statuses(client);
}

void StatusSocket::answer(const std::string& complaint) {
  for (Client& client : clients_)
    if (std::exchange(client.asks, false)) client.unsent.push_back(packet(StatusPacket::reload, complaint));
}

void StatusSocket::accept_all() {
  for (int fd = 0; (fd = ::accept4(fd_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK)) >= 0;) {
    if (clients_.size() < kMostClients && may_ask(fd))
      give_statuses(clients_.emplace_back(Client{fd}));
    else
      ::close(fd);
  }
}

bool StatusSocket::receive(Client& client) {
  char asked = 0;
  ssize_t n = 0;
  while ((n = ::recv(client.fd, &asked, 1, 0)) > 0)
    client.asks = client.asks || asked == static_cast<char>(StatusPacket::reload);
  return n < 0 && (errno == EAGAIN || errno == EINTR);
}

bool StatusSocket::send(Client& client) {
  for (; !client.unsent.empty(); client.unsent.pop_front()) {
    const std::string& next = client.unsent.front();
    if (::send(client.fd, next.data(), next.size(), MSG_NOSIGNAL) < 0) return errno == EAGAIN || errno == EINTR;
  }
  return true;
}

bool StatusSocket::serve() {
  if (fd_ < 0) return false;
  accept_all();
  bool asked = false;
  for (auto client = clients_.begin(); client != clients_.end();) {
    const bool there = receive(*client) && send(*client);
    asked = asked || (there && client->asks);
    if (!there) ::close(client->fd);
    client = there ? std::next(client) : clients_.erase(client);
  }
  return asked;
}

int connect_to_daemon(const std::string& folder, pid_t daemon) {
  const std::string path = folder + "/" + kSocketName;
  const auto fail = [&](const std::string& what) { throw std::runtime_error(path + ": " + what); };
  const Fd holder(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  struct stat there {
  }, owner{};
  if (::fstatat(holder, kSocketName, &there, AT_SYMLINK_NOFOLLOW) != 0 || ::fstat(holder, &owner) != 0)
    fail("the daemon (process " + std::to_string(daemon) + ") cannot be asked: " + socket_reason());
  if (!S_ISSOCK(there.st_mode)) fail("is no socket, expected that of the daemon");
  const int fd = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  const sockaddr_un address = address_in(holder);
  const timeval patience{3, 0};  // of a daemon that is stuck, whose backlog is full
  (void)::setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  if (::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    const int error = errno;
    ::close(fd);
    fail("the daemon (process " + std::to_string(daemon) + ") cannot be asked: " +
         std::generic_category().message(error) +
         (error == EACCES ? ", expected root, its own user or a member of its group" : ""));
  }
  const ucred peer = peer_of(fd);
  if (peer.pid == daemon && (peer.uid == 0 || peer.uid == owner.st_uid || peer.uid == ::geteuid())) return fd;
  ::close(fd);
  fail("is not of the daemon (process " + std::to_string(daemon) + "), but of process " +
       std::to_string(peer.pid) + " of user " + std::to_string(peer.uid));
  return -1;
}

}  // namespace ifog
