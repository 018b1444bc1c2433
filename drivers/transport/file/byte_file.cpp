// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/file/byte_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace ifog {
namespace {

bool is_gzip(int fd) {
  std::array<unsigned char, 2> magic{};
  return pread(fd, magic.data(), magic.size(), 0) == 2 && magic[0] == 0x1F && magic[1] == 0x8B;
}

}  // namespace

void ByteFile::open(const std::string& path) {
  const bool standard_input = path == "-";
  const auto fail = [&](int error) {
    throw OpenError(path, "cannot open", error, "a readable file or FIFO");
  };
  // Without O_NONBLOCK opening a FIFO would wait for its writer and could not be stopped.
  Fd fd(standard_input ? fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0)
                       : ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
  struct stat info {};
  if (fd < 0 || fstat(fd, &info) != 0) fail(errno);
  if (S_ISDIR(info.st_mode)) fail(EISDIR);
  if (!standard_input) sole_.take(fd, path);
  decltype(gz_) gz(nullptr, gzclose);
  if (S_ISREG(info.st_mode) && !standard_input && is_gzip(fd)) {
    gz.reset(gzdopen(fcntl(fd, F_DUPFD_CLOEXEC, 0), "rb"));
    if (gz == nullptr) fail(errno);
    gzdirect(gz.get());  // reads the header now, so that zlib's buffers are allocated before the first fill()
  }
  fd_ = std::move(fd);
  gz_ = std::move(gz);
  regular_ = S_ISREG(info.st_mode);
  fifo_ = S_ISFIFO(info.st_mode) && !standard_input;
  buffer_.resize(kCapacity);
  begin_ = end_ = 0;
}

void ByteFile::close() noexcept {
  sole_.release();
  gz_.reset();
  fd_.close();
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
    const int n = gzread(gz_.get(), buffer_.data() + end_, static_cast<unsigned>(room));
    if (n > 0) {
      end_ += static_cast<std::size_t>(n);
      return Fill::more;
    }
    int error = Z_OK;
    gzerror(gz_.get(), &error);
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
