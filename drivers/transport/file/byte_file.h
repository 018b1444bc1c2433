// SPDX-License-Identifier: Apache-2.0
// Buffered bytes of a file, a FIFO or standard input, for the file transport.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "drivers/transport/sole_reader.h"

namespace ifog {

class ByteFile {
 public:
  enum class Fill {
    more,       // bytes were added, or the buffer is full
    none,       // no data now (poll fd()), or interrupted while waiting
    end,        // end of a file, or the FIFO's writer closed it
    error,      // see errno
    truncated,  // a truncated or damaged gzip stream
  };

  ByteFile() = default;
  ~ByteFile() { close(); }
  ByteFile(const ByteFile&) = delete;
  ByteFile& operator=(const ByteFile&) = delete;

  // Throws OpenError. An open file is closed only after the new one is open, so that a reopened FIFO loses
  // nothing from a new writer.
  void open(const std::string& path);
  void close() noexcept;
  [[nodiscard]] bool is_fifo() const { return fifo_; }
  // A FIFO without a name: nobody can open it any more.
  [[nodiscard]] bool is_removed() const noexcept;
  // Readable if fill() may return data; −1: always (regular file).
  [[nodiscard]] int poll_fd() const { return regular_ ? -1 : fd_; }

  // True: fill() waits for data (pipes only).
  [[nodiscard]] bool blocks() const { return blocks_; }

  // Reads once, without allocating.
  Fill fill() noexcept;
  [[nodiscard]] std::span<const std::uint8_t> unread() const {
    return {buffer_.data() + begin_, end_ - begin_};
  }
  void consume(std::size_t n) { begin_ += n; }

  static constexpr std::size_t kCapacity = 1U << 16U;

 private:
  void close_file() noexcept;

  SoleReader sole_;
  int fd_ = -1;
  bool owned_ = false, regular_ = false, fifo_ = false, blocks_ = false;
  gzFile_s* gz_ = nullptr;
  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0, end_ = 0;
};

}  // namespace ifog
