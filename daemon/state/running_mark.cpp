// SPDX-License-Identifier: Apache-2.0
#include "daemon/state/running_mark.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <system_error>

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

}  // namespace

RunningMark::~RunningMark() {
  if (fd_ >= 0) ::close(fd_);
}

std::string RunningMark::set(const std::string& folder) {
  if (folder.empty()) return "";
  const std::string path = mark_path(folder);
  fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd_ < 0) return path + ": cannot mark that a daemon runs: " + reason(errno);
  // Others may look, whatever the umask.
  (void)!::fchmod(fd_, 0644);
  struct flock lock = whole_file(F_WRLCK);
  if (::fcntl(fd_, F_SETLK, &lock) == 0) return "";
  const int error = errno;
  if (error != EACCES && error != EAGAIN) return path + ": cannot mark that a daemon runs: " + reason(error);
  lock = whole_file(F_WRLCK);
  const bool known = ::fcntl(fd_, F_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
  return path + ": another daemon" + (known ? ", process " + std::to_string(lock.l_pid) + "," : "") +
         " works with this state folder; expected one of its own for each";
}

std::optional<pid_t> running_daemon(const std::string& folder) {
  const std::string path = mark_path(folder);
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0 && errno == ENOENT) return std::nullopt;
  if (fd < 0) throw std::runtime_error(path + ": cannot see whether the daemon runs: " + reason(errno));
  // Whether a lock for writing could be had may be asked by who can only read.
  struct flock lock = whole_file(F_WRLCK);
  const int done = ::fcntl(fd, F_GETLK, &lock);
  const int error = errno;
  ::close(fd);
  if (done != 0) throw std::runtime_error(path + ": cannot see whether the daemon runs: " + reason(error));
  if (lock.l_type == F_UNLCK) return std::nullopt;
  return lock.l_pid;
}

}  // namespace ifog
