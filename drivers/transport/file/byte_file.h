// SPDX-License-Identifier: Apache-2.0
// Buffered bytes of a file, a FIFO or standard input, for the file transport.
#pragma once

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "drivers/system/fd.h"
#include "drivers/transport/sole_reader.h"

namespace ifog {

class ByteFile {
 public:
  enum class Fill {
    more,       // bytes were added, or the buffer is full
    none,       // no data now
    end,        // end of a file, or the FIFO's writer closed it
    error,      // see errno
    truncated,  // a truncated or damaged gzip stream
  };

  // Throws OpenError. An open file is closed only after the new one is open, so that a reopened FIFO loses
  // nothing from a new writer.
  void open(const std::string& path);
  void close() noexcept;
  [[nodiscard]] bool is_fifo() const { return fifo_; }
  // A FIFO without a name: nobody can open it any more.
  [[nodiscard]] bool is_removed() const noexcept;
  // Readable if fill() may return data; −1: always (regular file).
  [[nodiscard]] int poll_fd() const { return regular_ ? -1 : fd_; }

  // Reads once, without allocating.
  Fill fill() noexcept;
  [[nodiscard]] std::span<const std::uint8_t> unread() const {
    return {buffer_.data() + begin_, end_ - begin_};
  }
  void consume(std::size_t n) { begin_ += n; }

  static constexpr std::size_t kCapacity = 1U << 16U;

 private:
  SoleReader sole_;
  Fd fd_;
  bool regular_ = false, fifo_ = false;
  std::unique_ptr<gzFile_s, int (*)(gzFile_s*)> gz_{nullptr, gzclose};  // with a descriptor of its own
  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0, end_ = 0;
};

}  // namespace ifog
