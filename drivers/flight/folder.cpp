// SPDX-License-Identifier: Apache-2.0
#include "drivers/flight/folder.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

namespace ifog {
namespace {

int result(int returned) { return returned == 0 ? 0 : errno; }

bool same_file(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

class DiskFolder final : public FlightFolder {
 public:
  explicit DiskFolder(std::string path) : path_(std::move(path)) {}
  ~DiskFolder() override {
    leave();
    let_go();
  }
  DiskFolder(const DiskFolder&) = delete;
  DiskFolder& operator=(const DiskFolder&) = delete;

  int list(std::vector<File>& out) override;
  int begin(const std::string& name) override;
  int append(std::span<const std::uint8_t> bytes) override;
  int finish(const std::string& name) override;
  void leave() override {
    if (fd_ >= 0) ::close(std::exchange(fd_, -1));
  }
  int take_over(const std::string& open_name, const std::string& name) override;
  int remove(const std::string& name) override { return result(::unlink(in(name).c_str())); }
  [[nodiscard]] std::string path() const override { return path_; }

 private:
  [[nodiscard]] std::string in(const std::string& name) const { return path_ + "/" + name; }
  // A new name is durable after its folder is synced.
  void sync_names() const {
    const int folder = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0) return;
    ::fsync(folder);
    ::close(folder);
  }
  // `to` must not exist.
  int rename_to(const std::string& from, const std::string& to) {
    const int error =
        result(::renameat2(AT_FDCWD, in(from).c_str(), AT_FDCWD, in(to).c_str(), RENAME_NOREPLACE));
    if (error == 0) sync_names();
    return error;
  }

  int keep_to_oneself();
  void let_go() {
    if (lock_fd_ >= 0) ::close(std::exchange(lock_fd_, -1));
  }
  [[nodiscard]] bool is_there() const;

  std::string path_, open_name_;
  int lock_fd_ = -1;  // of the folder; released when the process ends
  int fd_ = -1;
  off_t size_ = 0;
};

// Locks the folder itself, so that no lock file is needed. Ignored if the file system has no locks.
int DiskFolder::keep_to_oneself() {
  const int fd = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return errno;
  struct stat held {
  }, now{};
  const bool same =
      lock_fd_ >= 0 && ::fstat(lock_fd_, &held) == 0 && ::fstat(fd, &now) == 0 && same_file(held, now);
  const bool locked = !same && ::flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  if (same || locked) {
    ::close(fd);
    return locked ? EBUSY : 0;
  }
  let_go();
  lock_fd_ = fd;
  return 0;
}

int DiskFolder::list(std::vector<File>& out) {
  out.clear();
  std::error_code error;
  if (std::filesystem::create_directories(path_, error)) ::chmod(path_.c_str(), 0750);
  if (error) return error.value();
  if (const int refused = keep_to_oneself(); refused != 0) return refused;
  DIR* const folder = ::opendir(path_.c_str());
  if (folder == nullptr) return errno;
  while (const dirent* const entry = ::readdir(folder)) {
    struct stat info {};
    if (::fstatat(::dirfd(folder), entry->d_name, &info, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISREG(info.st_mode))
      continue;
    out.push_back({entry->d_name, static_cast<std::uint64_t>(info.st_size),
                   info.st_mtim.tv_sec * 1'000'000'000LL + info.st_mtim.tv_nsec});
  }
  ::closedir(folder);
  return 0;
}

int DiskFolder::begin(const std::string& name) {
  leave();
  fd_ = ::open(in(name).c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0640);
  if (fd_ < 0) return errno;
  // Regardless of the umask: readable by the group only.
  ::fchmod(fd_, 0640);
  // Marks the file as being written; released when the process ends.
  ::flock(fd_, LOCK_EX | LOCK_NB);
  open_name_ = name;
  size_ = 0;
  return 0;
}

// True if the open file still exists under its name.
bool DiskFolder::is_there() const {
  struct stat open {
  }, named{};
  return ::fstat(fd_, &open) == 0 && ::stat(in(open_name_).c_str(), &named) == 0 && same_file(open, named);
}

int DiskFolder::append(std::span<const std::uint8_t> bytes) {
  if (fd_ < 0) return EBADF;
  if (!is_there()) {
    leave();
    return ENOENT;
  }
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::write(fd_, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      const int error = n < 0 ? errno : EIO;
      if (::ftruncate(fd_, size_) != 0 || ::lseek(fd_, size_, SEEK_SET) != size_) leave();
      return error;
    }
    done += static_cast<std::size_t>(n);
  }
  size_ += static_cast<off_t>(bytes.size());
  return 0;
}

int DiskFolder::finish(const std::string& name) {
  if (fd_ < 0) return EBADF;
  const int error = result(::fsync(fd_));
  const int renamed = error != 0 ? error : rename_to(open_name_, name);
  leave();
  return renamed;
}

int DiskFolder::take_over(const std::string& open_name, const std::string& name) {
  const int fd = ::open(in(open_name).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (fd < 0) return errno;
  int error = ::flock(fd, LOCK_EX | LOCK_NB) != 0 ? EBUSY : result(::fsync(fd));
  if (error == 0) error = rename_to(open_name, name);
  ::close(fd);
  return error;
}

}  // namespace

std::unique_ptr<FlightFolder> make_flight_folder(std::string path) {
  return std::make_unique<DiskFolder>(std::move(path));
}

}  // namespace ifog
