// SPDX-License-Identifier: Apache-2.0
// A table of any size in blocks of columns, within a block row behind row. So some of its rows, and some of
// its columns, are both in a few long pieces. Where it is long it is in a file, read and written as one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

#include "filters/series/mapped_file.h"
#include "filters/series/samples.h"

namespace ifog {

template <typename T>
class BlockedTable {
 public:
  // begins: first column of each block, from 0 on. Throws std::runtime_error where the file finds no room, as
  // all here.
  BlockedTable(std::size_t rows, std::size_t columns, std::vector<std::size_t> begins)
      : rows_(rows), begins_(std::move(begins)), values_(rows * columns, FiledAllocator<T>(true)) {
    begins_.push_back(columns);
  }
  BlockedTable(std::size_t rows, std::size_t columns, std::size_t block_columns)
      : BlockedTable(rows, columns, evenly(columns, block_columns)) {}

  [[nodiscard]] std::size_t blocks() const { return begins_.size() - 1; }
  [[nodiscard]] std::size_t begin(std::size_t block) const { return begins_[block]; }
  [[nodiscard]] std::size_t width(std::size_t block) const { return begins_[block + 1] - begins_[block]; }
  [[nodiscard]] std::size_t widest() const {
    std::size_t most = 0;
    for (std::size_t b = 0; b < blocks(); ++b) most = std::max(most, width(b));
    return most;
  }

  // rows from `row` on of one block, one behind the other.
  void write(std::size_t block, std::size_t row, std::size_t rows, const T* from) {
    T* const to = values_.data() + place(block, row);
    const std::size_t bytes = rows * width(block) * sizeof(T);
    if (filed())
      write_new_file(to, from, bytes);
    else
      std::memcpy(static_cast<void*>(to), from, bytes);
  }
  void read(std::size_t block, std::size_t row, std::size_t rows, T* to) const {
    const T* const from = values_.data() + place(block, row);
    const std::size_t bytes = rows * width(block) * sizeof(T);
    if (filed())
      read_new_file(to, from, bytes);
    else
      std::memcpy(static_cast<void*>(to), from, bytes);
  }

 private:
  static std::vector<std::size_t> evenly(std::size_t columns, std::size_t each) {
    std::vector<std::size_t> begins;
    for (std::size_t at = 0; at < columns; at += each) begins.push_back(at);
    return begins;
  }
  [[nodiscard]] std::size_t place(std::size_t block, std::size_t row) const {
    return begins_[block] * rows_ + row * width(block);
  }
  [[nodiscard]] bool filed() const { return values_.size() * sizeof(T) > FiledAllocator<T>::kInMemory; }

  std::size_t rows_;
  std::vector<std::size_t> begins_;  // and, behind the last, how many columns there are
  FiledVector<T> values_;
};

}  // namespace ifog
