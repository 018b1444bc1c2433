// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/file/byte_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace ifog {
namespace {

[[noreturn]] void fail(const std::string& path) {
  throw OpenError(path, "cannot open", errno, "a readable file or FIFO");
}

bool is_gzip(int fd) {
  std::array<unsigned char, 2> magic{};
  return pread(fd, magic.data(), magic.size(), 0) == 2 && magic[0] == 0x1F && magic[1] == 0x8B;
}

}  // namespace

void ByteFile::open(const std::string& path) {
  const bool standard_input = path == "-";
  // Without O_NONBLOCK opening a FIFO would wait for its writer and could not be stopped.
  const int fd =
      standard_input ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
  if (fd < 0) fail(path);
  struct stat info {};
  if (fstat(fd, &info) != 0 || S_ISDIR(info.st_mode)) {
    const int error = S_ISDIR(info.st_mode) ? EISDIR : errno;
    if (!standard_input) ::close(fd);
    errno = error;
    fail(path);
  }
  if (!standard_input) {
    try {
      sole_.take(fd, path);
    } catch (...) {
      ::close(fd);
      throw;
    }
  }
  gzFile_s* gz = nullptr;
  if (S_ISREG(info.st_mode) && !standard_input && is_gzip(fd)) {
    gz = gzdopen(fd, "rb");
    if (gz == nullptr) {
      ::close(fd);
      fail(path);
    }
    gzdirect(gz);  // reads the header now, so that zlib's buffers are allocated before the first fill()
  }
  close_file();
  if (standard_input) sole_.release();
  fd_ = fd;
  gz_ = gz;
  owned_ = !standard_input;
  regular_ = S_ISREG(info.st_mode);
  fifo_ = S_ISFIFO(info.st_mode) && owned_;
  // Flags of a foreign standard input are not changed.
  const int flags = fcntl(fd, F_GETFL);
  blocks_ = S_ISFIFO(info.st_mode) && flags >= 0 &&
            (owned_ ? fcntl(fd, F_SETFL, flags & ~O_NONBLOCK) == 0 : (flags & O_NONBLOCK) == 0);
  buffer_.resize(kCapacity);
  begin_ = end_ = 0;
}

void ByteFile::close() noexcept {
  sole_.release();
  close_file();
}

void ByteFile::close_file() noexcept {
  if (gz_ != nullptr)
    gzclose(gz_);
  else if (fd_ >= 0 && owned_)
    ::close(fd_);
  gz_ = nullptr;
  fd_ = -1;
}

bool ByteFile::is_removed() const noexcept {
  struct stat info {};
  return fifo_ && ::fstat(fd_, &info) == 0 && info.st_nlink == 0;
}

ByteFile::Fill ByteFile::fill() noexcept {
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  const std::size_t room = buffer_.size() - end_;
  if (room == 0) return Fill::more;
  if (gz_ != nullptr) {
    const int n = gzread(gz_, buffer_.data() + end_, static_cast<unsigned>(room));
    if (n > 0) {
      end_ += static_cast<std::size_t>(n);
      return Fill::more;
    }
    int error = Z_OK;
    gzerror(gz_, &error);
    if (error == Z_ERRNO) return Fill::error;
    return error == Z_OK || error == Z_STREAM_END ? Fill::end : Fill::truncated;
  }
  const ssize_t n = ::read(fd_, buffer_.data() + end_, room);
  if (n > 0) {
    end_ += static_cast<std::size_t>(n);
    return Fill::more;
  }
  if (n == 0) return Fill::end;
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR ? Fill::none : Fill::error;
}

}  // namespace ifog
