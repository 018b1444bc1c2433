// SPDX-License-Identifier: Apache-2.0
// Unnamed file for numbers that do not fit into memory, in $TMPDIR or else /var/tmp or /tmp. It disappears
// with the process. Header only.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <stdexcept>
#include <string>
#include <system_error>

#include "drivers/system/fd.h"

namespace ifog {

class UnnamedFile {
 public:
  // All functions throw std::runtime_error with one line: no space, or an I/O error.
  UnnamedFile() : fd_(opened()) {}

  // first: position in the file, counted in numbers.
  void write(std::size_t first, std::span<const double> numbers) {
    write(first * sizeof(double), numbers.data(), numbers.size_bytes());
  }
  // offset, left: bytes.
  void write(std::size_t offset, const void* from, std::size_t left) {
    const char* at = static_cast<const char*>(from);
    while (left > 0) {
      const ssize_t n = ::pwrite(fd_, at, left, static_cast<off_t>(offset));
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) fail("cannot write");
      at += n;
      left -= static_cast<std::size_t>(n);
      offset += static_cast<std::size_t>(n);
    }
  }

  // Reads to.size() numbers, which must exist. Several threads may read at once.
  void read(std::size_t first, std::span<double> to) const {
    read(first * sizeof(double), to.data(), to.size_bytes());
  }
  void read(std::size_t offset, void* to, std::size_t left) const {
    char* at = static_cast<char*>(to);
    while (left > 0) {
      const ssize_t n = ::pread(fd_, at, left, static_cast<off_t>(offset));
      if (n < 0 && errno == EINTR) continue;
      if (n == 0) errno = EIO;
      if (n <= 0) fail("cannot read");
      at += n;
      left -= static_cast<std::size_t>(n);
      offset += static_cast<std::size_t>(n);
    }
  }

  // Bytes.
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(::lseek(fd_, 0, SEEK_END)); }
  // For mmap().
  [[nodiscard]] int descriptor() const { return fd_; }
  // what: the failed action; errno is set.
  [[noreturn]] static void fail(const char* what) {
    const std::string reason = std::generic_category().message(errno);
    throw std::runtime_error(folder() + ": " + what + " a file for what is longer than memory is for: " +
                             reason + "; expected room there, or TMPDIR with the name of another folder");
  }

 private:
  static std::string folder() {
    const char* const named = std::getenv("TMPDIR");
    if (named != nullptr && *named != '\0') return named;
    // /tmp may be in memory.
    return ::access("/var/tmp", W_OK | X_OK) == 0 ? "/var/tmp" : "/tmp";
  }

  static int opened() {
    const std::string where = folder();
    const int fd = ::open(where.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (fd >= 0) return fd;
    std::string name = where + "/ifog-XXXXXX";
    const int named = ::mkostemp(name.data(), O_CLOEXEC);
    if (named < 0) fail("cannot make");
    ::unlink(name.c_str());
    return named;
  }

  Fd fd_;
};

}  // namespace ifog
