// SPDX-License-Identifier: Apache-2.0
#include "daemon/state/running_mark.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

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
  // With a second name it is somebody else's file, whose rights are not ours to change.
  return ::fstat(fd, &what) == 0 && S_ISREG(what.st_mode) && what.st_nlink == 1;
}

}  // namespace

RunningMark::~RunningMark() {
  if (fd_ >= 0) ::close(fd_);
}

std::string RunningMark::set(const std::string& folder) {
  taken_ = false;
  if (folder.empty()) return "";
  const std::string path = mark_path(folder);
  // Never through a link, and no FIFO: who may write into the folder may have put one there.
  fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0644);
  if (fd_ < 0) return path + ": cannot mark that a daemon runs: " + reason(errno);
  if (!is_plain(fd_)) {
    ::close(std::exchange(fd_, -1));
    return path + ": cannot mark that a daemon runs: no regular file";
  }
  // Others may look, whatever the umask.
  (void)!::fchmod(fd_, 0644);
  struct flock lock = whole_file(F_WRLCK);
  if (::fcntl(fd_, F_SETLK, &lock) == 0) return "";
  const int error = errno;
  if (error != EACCES && error != EAGAIN) {
    ::close(std::exchange(fd_, -1));
    return path + ": cannot mark that a daemon runs: " + reason(error);
  }
  lock = whole_file(F_WRLCK);
  const bool known = ::fcntl(fd_, F_GETLK, &lock) == 0 && lock.l_type == F_WRLCK && lock.l_pid > 0;
  ::close(std::exchange(fd_, -1));
  taken_ = true;
  return path + ": another daemon" + (known ? ", process " + std::to_string(lock.l_pid) + "," : "") +
         " works with this state folder; expected one of its own for each";
}

std::optional<pid_t> running_daemon(const std::string& folder) {
  const std::string path = mark_path(folder);
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (fd < 0 && errno == ENOENT) return std::nullopt;
  if (fd < 0) throw std::runtime_error(path + ": cannot see whether the daemon runs: " + reason(errno));
  if (!is_plain(fd)) {
    ::close(fd);
    throw std::runtime_error(path + ": cannot see whether the daemon runs: no regular file");
  }
  // Whether a lock for writing could be had may be asked by who can only read.
  struct flock lock = whole_file(F_WRLCK);
  const int done = ::fcntl(fd, F_GETLK, &lock);
  const int error = errno;
  ::close(fd);
  if (done != 0) throw std::runtime_error(path + ": cannot see whether the daemon runs: " + reason(error));
  if (lock.l_type == F_UNLCK) return std::nullopt;
  // A lock of no process (-1), of one in another namespace (0) or for reading is not the daemon's: a signal
  // to such a number goes to others.
  if (lock.l_type != F_WRLCK || lock.l_pid <= 0)
    throw std::runtime_error(path +
                             ": is locked by no process that can be seen from here, expected the daemon");
  return lock.l_pid;
}

}  // namespace ifog
