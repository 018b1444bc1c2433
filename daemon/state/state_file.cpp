// SPDX-License-Identifier: Apache-2.0
#include "daemon/state/state_file.h"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace ifog {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw std::runtime_error(path + ": " + what);
}
std::string reason() { return std::generic_category().message(errno); }

// A descriptor that is closed.
class Fd {
 public:
  explicit Fd(int fd) : fd_(fd) {}
  ~Fd() {
    if (fd_ >= 0) ::close(fd_);
  }
  Fd(const Fd&) = delete;
  Fd& operator=(const Fd&) = delete;
  operator int() const { return fd_; }

 private:
  int fd_;
};

struct Place {
  std::string folder, name;
};
Place place_of(const std::string& path) {
  const std::filesystem::path whole(path);
  const std::string folder = whole.parent_path().string();
  return {folder.empty() ? "." : folder, whole.filename().string()};
}

// What nobody can have put there before.
std::string unforeseen_name(const std::string& name) {
  std::uint64_t number = 0;
  if (::getrandom(&number, sizeof number, 0) != static_cast<ssize_t>(sizeof number))
    throw std::runtime_error("no random numbers: " + reason());
  std::array<char, 20> digits{};
  std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(number));
  return "." + name.substr(0, 200) + "." + digits.data();
}

void write_all(int fd, const std::string& path, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(path, "cannot be written: " + reason());
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace

void write_state_file(const std::string& path, std::string_view bytes) {
  const Place place = place_of(path);
  const Fd folder(::open(place.folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder < 0) fail(path, "its folder cannot be opened: " + reason());
  struct stat there {};
  if (::fstatat(folder, place.name.c_str(), &there, AT_SYMLINK_NOFOLLOW) == 0 && !S_ISREG(there.st_mode))
    fail(path, "is no regular file, which is not written in a state folder");
  const std::string beside = unforeseen_name(place.name);
  const Fd file(::openat(folder, beside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0664));
  if (file < 0) fail(path, "cannot be written: " + reason());
  try {
    write_all(file, path, bytes);
    if (::fsync(file) != 0) fail(path, "cannot be written: " + reason());
    if (::renameat(folder, beside.c_str(), folder, place.name.c_str()) != 0)
      fail(path, "cannot be put in place: " + reason());
  } catch (...) {
    ::unlinkat(folder, beside.c_str(), 0);
    throw;
  }
  (void)::fsync(folder);
}

std::string read_state_file(const std::string& path, std::size_t most) {
  const Fd file(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (file < 0)
    fail(path,
         errno == ELOOP ? "is a link, expected a file of the state folder" : "cannot be read: " + reason());
  struct stat there {};
  if (::fstat(file, &there) != 0 || !S_ISREG(there.st_mode))
    fail(path, "is no regular file, expected one of the state folder");
  if (there.st_nlink != 1)
    fail(path, "has other names beside this one, expected a file of the state folder alone");
  std::string text;
  std::array<char, 65536> piece;
  for (;;) {
    const ssize_t count = ::read(file, piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(path, "cannot be read: " + reason());
    if (count == 0) return text;
    text.append(piece.data(), static_cast<std::size_t>(count));
    if (text.size() > most)
      fail(path, "is longer than " + std::to_string(most) + " bytes, which no file of the state folder is");
  }
}

}  // namespace ifog
