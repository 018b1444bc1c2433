// SPDX-License-Identifier: Apache-2.0
#include "daemon/state/running_mark.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "daemon/state/state_folder.h"

namespace ifog {
namespace {

std::string mark_path(const std::string& folder) {
  return (std::filesystem::path(folder) / "ifogd.lock").string();
}

std::string reason(int error) { return std::generic_category().message(error); }

struct flock whole_file(short type) {
  struct flock lock {};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  return lock;
}

bool is_plain(int fd) {
  struct stat what {};
  // A second name means it is another's file, whose permissions must not be changed.
  return ::fstat(fd, &what) == 0 && S_ISREG(what.st_mode) && what.st_nlink == 1;
}

constexpr const char* kSocketName = "ifogd.socket";
constexpr std::size_t kMostClients = 16;

// Relative to the open folder, whose path may be too long for an address.
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

// Root, this user, and the folder's group, which may store models there.
bool may_ask(int fd, gid_t group) {
  const ucred peer = peer_of(fd);
  if (peer.uid == 0 || peer.uid == ::geteuid() || peer.gid == group) return true;
  std::array<gid_t, 1024> groups{};
  socklen_t size = sizeof groups;
  if (::getsockopt(fd, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &size) != 0) return false;
  const gid_t* const end = groups.data() + size / sizeof groups[0];
  return std::find(static_cast<const gid_t*>(groups.data()), end, group) != end;
}

// What does not fit into the socket is lost; the other end detects the truncation.
void reply(int fd, const std::string& text) {
  const int room = 1 << 20;  // bytes; less by net.core.wmem_max
  (void)::setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &room, sizeof room);
  (void)::send(fd, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
}

}  // namespace

std::string RunningMark::set(const std::string& folder) {
  in_use_ = false;
  if (folder.empty()) return "";
  const std::string path = mark_path(folder);
  const auto cannot = [&](const std::string& why) {
    fd_.close();
    return path + ": cannot mark that a daemon runs: " + why;
  };
  // No link and no FIFO, which others with write access may have created.
  fd_ = Fd(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0644));
  if (fd_ < 0) return cannot(reason(errno));
  if (!is_plain(fd_)) return cannot("no regular file");
  // Readable by others, regardless of the umask.
  (void)!::fchmod(fd_, 0644);
  struct flock lock = whole_file(F_WRLCK);
  if (::fcntl(fd_, F_SETLK, &lock) == 0) return listen_in(folder);
  if (errno != EACCES && errno != EAGAIN) return cannot(reason(errno));
  lock = whole_file(F_WRLCK);
  const bool known = ::fcntl(fd_, F_GETLK, &lock) == 0 && lock.l_type == F_WRLCK && lock.l_pid > 0;
  fd_.close();
  in_use_ = true;
  return path + ": another daemon" + (known ? ", process " + std::to_string(lock.l_pid) + "," : "") +
         " works with this state folder; expected one of its own for each";
}

std::string RunningMark::listen_in(const std::string& folder) {
  const Fd holder(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  struct stat there {};
  if (::fstat(holder, &there) == 0) group_ = there.st_gid;
  socket_ = Fd(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  // Removes the socket of a killed daemon, or anything of this name, without following it.
  (void)::unlinkat(holder, kSocketName, 0);
  const sockaddr_un address = address_in(holder);
  // The mode regardless of the service's umask, so that the group can connect.
  if (::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
      ::fchmodat(holder, kSocketName, S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP, AT_SYMLINK_NOFOLLOW) == 0 &&
      ::listen(socket_, static_cast<int>(kMostClients)) == 0)
    return "";
  return folder + "/" + kSocketName + ": ifog status and adopt cannot ask this daemon: " + reason(errno);
}

void RunningMark::tell(const std::vector<std::string>& statuses) {
  statuses_.clear();
  for (const std::string& status : statuses) {
    const auto bytes = static_cast<std::uint32_t>(status.size());
    statuses_.append(reinterpret_cast<const char*>(&bytes), sizeof bytes).append(status);
  }
}

void RunningMark::answer(const std::string& complaint) {
  std::erase_if(clients_, [&](const auto& client) {
    const bool asks = client.second == static_cast<char>(DaemonQuestion::reload);
    if (asks) reply(client.first, complaint);
    return asks;
  });
}

bool RunningMark::serve() {
  for (int fd = 0; (fd = ::accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC)) >= 0;) {
    Fd client(fd);
    if (may_ask(client, group_)) clients_.emplace_back(std::move(client), 0);
    if (clients_.size() > kMostClients) clients_.erase(clients_.begin());
  }
  bool asked = false;
  std::erase_if(clients_, [&](auto& client) {
    auto& [fd, question] = client;
    char letter = 0;
    const ssize_t n = ::recv(fd, &letter, 1, MSG_DONTWAIT);
    if (n > 0) question = letter;
    asked = asked || question == static_cast<char>(DaemonQuestion::reload);
    const bool answered = question == static_cast<char>(DaemonQuestion::status) && !statuses_.empty();
    if (answered) reply(fd, statuses_);
    return answered || n == 0 || (n < 0 && errno != EAGAIN);
  });
  return asked;
}

std::optional<pid_t> running_daemon(const std::string& folder) {
  const std::string path = mark_path(folder);
  const Fd fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  if (fd < 0 && errno == ENOENT) return std::nullopt;
  // Testing for a write lock needs only read access.
  struct flock lock = whole_file(F_WRLCK);
  if (fd < 0 || !is_plain(fd) || ::fcntl(fd, F_GETLK, &lock) != 0)
    throw std::runtime_error(path + ": cannot see whether the daemon runs: " +
                             (fd < 0 || is_plain(fd) ? reason(errno) : "no regular file"));
  if (lock.l_type == F_UNLCK) return std::nullopt;
  // A lock of no process (-1), of one in another namespace (0) or for reading is not the daemon's: a signal
  // to such a number goes to others.
  if (lock.l_type != F_WRLCK || lock.l_pid <= 0)
    throw std::runtime_error(path +
                             ": is locked by no process that can be seen from here, expected the daemon");
  return lock.l_pid;
}

std::string ask_daemon(const std::string& folder, pid_t daemon, DaemonQuestion question,
                       std::chrono::milliseconds most) {
  const std::string who = "the daemon (process " + std::to_string(daemon) + ")";
  const auto fail = [&](const std::string& what) {
    throw std::runtime_error(folder + "/" + kSocketName + ": " + what);
  };
  const Fd holder(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  struct stat there {
  }, owner{};
  if (::fstatat(holder, kSocketName, &there, AT_SYMLINK_NOFOLLOW) != 0 || ::fstat(holder, &owner) != 0)
    fail(who + " cannot be asked: " + reason(errno));
  if (!S_ISSOCK(there.st_mode)) fail("is no socket, expected that of the daemon");
  const Fd fd(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(most).count();
  const timeval patience{us / 1'000'000, us % 1'000'000};
  for (const int option : {SO_SNDTIMEO, SO_RCVTIMEO})  // the backlog may be full, too
    (void)::setsockopt(fd, SOL_SOCKET, option, &patience, sizeof patience);
  const sockaddr_un address = address_in(holder);
  if (::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    fail(who + " cannot be asked: " + reason(errno) +
         (errno == EACCES ? ", expected root, its own user or a member of its group" : ""));
  const ucred peer = peer_of(fd);
  if (peer.pid != daemon || (peer.uid != 0 && peer.uid != owner.st_uid && peer.uid != ::geteuid()))
    fail("is not of " + who + ", but of process " + std::to_string(peer.pid) + " of user " +
         std::to_string(peer.uid));
  const char letter = static_cast<char>(question);
  std::string answer;
  std::array<char, 65536> piece;
  ssize_t n = ::send(fd, &letter, 1, MSG_NOSIGNAL);
  while (n > 0 && (n = ::recv(fd, piece.data(), piece.size(), 0)) > 0)
    answer.append(piece.data(), static_cast<std::size_t>(n));
  if (n < 0) fail(who + " does not answer: " + reason(errno));
  return answer;
}

}  // namespace ifog
