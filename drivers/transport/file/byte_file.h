// SPDX-License-Identifier: Apache-2.0
// Bytes of a file, a FIFO or the standard input in a fixed buffer: what is under the file transport.
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
    none,       // nothing there now (poll fd()), or interrupted while it waited for some
    end,        // the end of a file, or a FIFO's writer went away
    error,      // errno says why
    truncated,  // a gzip stream that ends early or is damaged
  };

  ByteFile() = default;
  ~ByteFile() { close(); }
  ByteFile(const ByteFile&) = delete;
  ByteFile& operator=(const ByteFile&) = delete;

  // Throws OpenError. A file open already stays open until the new one is: a FIFO so
  // opened again loses nothing that a new writer has put in.
  void open(const std::string& path);
  void close() noexcept;
  [[nodiscard]] bool is_open() const { return fd_ >= 0; }
  [[nodiscard]] bool is_fifo() const { return fifo_; }
  // Readable when fill() may bring something; −1: always (a regular file).
  [[nodiscard]] int poll_fd() const { return regular_ ? -1 : fd_; }

  // True: fill() waits until something is there, which only pipes are let.
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
