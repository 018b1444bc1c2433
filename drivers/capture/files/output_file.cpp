// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/files/output_file.h"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "drivers/capture/files/file_kind.h"

namespace ifog {
namespace {

namespace fs = std::filesystem;

struct Destination {
  fs::path file;        // target of links
  int descriptor = -1;  // or an open descriptor of this process
};

bool is_number(const std::string& text) {
  return !text.empty() && std::ranges::all_of(text, [](unsigned char c) { return std::isdigit(c); });
}

// Follows link by link, because realpath() needs an existing file, and a link in /proc/self/fd means an open
// descriptor with its offset. Sets `error` for invalid paths.
Destination follow(const fs::path& path, std::error_code& error) {
  constexpr int kMostLinks = 40;  // as in the kernel
  fs::path at = path;
  for (int links = 0; links < kMostLinks; ++links) {
    const fs::path folder = fs::canonical(at.has_parent_path() ? at.parent_path() : fs::path("."), error);
    if (error) return {};
    const std::string name = at.filename();
    if (folder == "/proc/" + std::to_string(getpid()) + "/fd" && is_number(name))
      return {{}, std::atoi(name.c_str())};
    at = folder / name;
    if (!fs::is_symlink(fs::symlink_status(at, error))) {
      error.clear();
      return {at};
    }
    const fs::path to = fs::read_symlink(at, error);
    if (error) return {};
    at = to.is_absolute() ? to : folder / to;
  }
  error = std::make_error_code(std::errc::too_many_symbolic_link_levels);
  return {};
}

Destination destination_of(const std::string& path, std::error_code& error) {
  if (path == "-") return {{}, STDOUT_FILENO};
  return follow(path, error);
}

// Temporary name. Without the process number: a file left after a kill would block later processes with that
// number.
std::string passing_name() {
  std::uint64_t number = 0;
  if (::getrandom(&number, sizeof number, 0) != static_cast<ssize_t>(sizeof number))
    number = static_cast<std::uint64_t>(getpid());
  return ".ifog-" + std::to_string(number) + ".part";
}

}  // namespace

bool is_standard_output(const std::string& path) {
  std::error_code error;
  return !path.empty() && destination_of(path, error).descriptor == STDOUT_FILENO;
}

std::optional<FileIdentity> file_identity(const std::string& path) {
  std::error_code error;
  const Destination to = destination_of(path, error);
  if (error) return std::nullopt;
  struct stat info {};
  const bool there =
      to.descriptor >= 0 ? ::fstat(to.descriptor, &info) == 0 : ::stat(to.file.c_str(), &info) == 0;
  if (there) {
    if (!S_ISREG(info.st_mode)) return std::nullopt;
    return FileIdentity{info.st_dev, info.st_ino, ""};
  }
  if (to.descriptor >= 0 || to.file.filename().empty() || ::stat(to.file.parent_path().c_str(), &info) != 0)
    return std::nullopt;
  return FileIdentity{info.st_dev, info.st_ino, to.file.filename().string()};
}

void expect_writable(const std::string& path) {
  std::error_code error;
  const Destination to = destination_of(path, error);
  struct stat info {};
  const bool there = !error && to.descriptor < 0 && ::stat(to.file.c_str(), &info) == 0;
  if (to.descriptor >= 0 || (there && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode))) return;
  const OutputFile probe(path);
}

OutputFile::OutputFile(std::string path, int descriptor) : path_(std::move(path)), fd_(descriptor) {}

// Delegates, so that a failure here runs the destructor.
OutputFile::OutputFile(std::string path) : OutputFile(std::move(path), -1) {
  open();
  if (!is_packed_name(path_)) return;
  packed_ = gzdopen(fcntl(fd_, F_DUPFD_CLOEXEC, 3), "wb");
  if (packed_ == nullptr) throw std::runtime_error("zlib: cannot start compression");
}

void OutputFile::open() {
  std::error_code error;
  const Destination to = destination_of(path_, error);
  if (error) {
    errno = error.value();
    fail("cannot create");
  }
  if (to.descriptor >= 0) {
    std::fflush(stdout);  // keeps the order with printed output
    fd_ = fcntl(to.descriptor, F_DUPFD_CLOEXEC, 3);
    if (fd_ < 0) fail("cannot write");
    return;
  }
  struct stat info {};
  const bool there = ::stat(to.file.c_str(), &info) == 0;
  if ((there && S_ISDIR(info.st_mode)) || to.file.filename().empty())
    throw std::runtime_error(path_ + ": is a folder, expected a file to write");
  if (there && !S_ISREG(info.st_mode)) {
    fd_ = ::open(to.file.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
    if (fd_ < 0) fail("cannot write");
    return;
  }
  // Renaming over a file does not need write permission for it.
  if (there && ::access(to.file.c_str(), W_OK) != 0) fail("cannot write");
  target_ = to.file;
  open_temporary();
  if (!there) return;
  if (info.st_uid != geteuid() || info.st_gid != getegid()) (void)!fchown(fd_, info.st_uid, info.st_gid);
  if (fchmod(fd_, info.st_mode & 0777U) != 0) fail("cannot keep the mode of");
}

void OutputFile::open_temporary() {
  const fs::path folder = fs::path(target_).parent_path();
  // An unnamed file disappears if the program is killed or power fails.
  const bool can_name = ::access("/proc/self/fd", X_OK) == 0;
  if (can_name) fd_ = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
  if (fd_ >= 0) return;
  const bool unknown =
      !can_name || errno == EOPNOTSUPP || errno == EISDIR || errno == ENOENT || errno == EINVAL;
  if (!unknown) fail("cannot create");
  temporary_ = folder / passing_name();
  fd_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd_ < 0) {
    temporary_.clear();
    fail("cannot create");
  }
}

OutputFile::~OutputFile() {
  if (packed_ != nullptr) gzclose(packed_);
  if (fd_ >= 0) ::close(fd_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void OutputFile::fail(const char* what) const {
  const int error = errno;
  if (fd_ >= 0 && target_.empty() && path_ == "-")
    throw std::runtime_error(std::string("standard output: ") + what + ": " +
                             std::generic_category().message(error));
  throw std::runtime_error(path_ + ": " + what + ": " + std::generic_category().message(error));
}

void OutputFile::write(std::string_view bytes) {
  constexpr std::size_t kMostAtOnce = 1U << 30U;  // zlib's limit
  while (packed_ != nullptr && !bytes.empty()) {
    const std::string_view some = bytes.substr(0, kMostAtOnce);
    errno = 0;
    if (gzwrite(packed_, some.data(), static_cast<unsigned>(some.size())) <= 0) fail("cannot write");
    bytes.remove_prefix(some.size());
  }
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd_, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("cannot write");
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

// Blocks signals between the two calls, so that no temporary name remains.
void OutputFile::take_the_name() {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  bool done = true;
  if (temporary_.empty()) {
    const fs::path passing = fs::path(target_).parent_path() / passing_name();
    const std::string own = "/proc/self/fd/" + std::to_string(fd_);
    done = ::linkat(AT_FDCWD, own.c_str(), AT_FDCWD, passing.c_str(), AT_SYMLINK_FOLLOW) == 0;
    if (done) temporary_ = passing;
  }
  done = done && ::rename(temporary_.c_str(), target_.c_str()) == 0;
  const int error = errno;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  errno = error;
  if (!done) fail("cannot rename into place");
  temporary_.clear();
}

void OutputFile::finish() {
  errno = 0;
  if (packed_ != nullptr && gzclose(std::exchange(packed_, nullptr)) != Z_OK) fail("cannot write");
  if (!target_.empty()) {
    if (::fsync(fd_) != 0) fail("cannot sync");
    take_the_name();
    // The name is durable after its folder is synced.
    const int folder = ::open(fs::path(target_).parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder >= 0) {
      ::fsync(folder);
      ::close(folder);
    }
  }
  const int fd = std::exchange(fd_, -1);
  if (::close(fd) != 0 && errno != EINTR) fail("cannot write");
}

void write_file(const std::string& path, std::string_view bytes) {
  OutputFile file(path);
  file.write(bytes);
  file.finish();
}

}  // namespace ifog
