// SPDX-License-Identifier: Apache-2.0
// A growing unnamed file as memory. The kernel may evict its pages. A thread also releases pages when more
// than kMostResident bytes are resident; they remain in the page cache or are read again from the file.
#pragma once

#include <cstddef>

#include "drivers/system/unnamed_file.h"

namespace ifog {

inline constexpr std::size_t kMostResident = std::size_t{128} << 20U;  // bytes of all files

// Largest number of released files kept for reuse.
inline constexpr std::size_t kMostSpare = 4;

class MappedFile {
 public:
  // expected: bytes it will have, if that is known; then its memory does not move. All functions throw
  // std::runtime_error with one line: no space for the file, or an I/O error.
  explicit MappedFile(std::size_t expected);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  // Bytes that may be read and written, of arbitrary content at first.
  [[nodiscard]] char* data() const { return at_; }
  [[nodiscard]] std::size_t size() const { return filed_ + kPiece; }
  // Adds kPiece bytes. Those before them must have been written. The memory may move.
  void extend();

 private:
  // The last bytes are ordinary memory, and are written to the file at once: creating a page of a file by
  // writing into the mapping costs ten times as much on some kernels.
  static constexpr std::size_t kPiece = std::size_t{1} << 19U;

  void reserve(std::size_t bytes);

  UnnamedFile file_;       // may be a reused one
  char* at_ = nullptr;     // the file, the piece, then reserved addresses
  std::size_t filed_ = 0;  // bytes that are in the file
  std::size_t reserved_ = 0;
};

}  // namespace ifog
