// SPDX-License-Identifier: Apache-2.0
// A column of one value per sample, of any length. It works like std::vector: short ones are in memory, longer
// ones in an unnamed file that is mapped into memory, so that only a part of it is resident (mapped_file.h).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "filters/series/mapped_file.h"

namespace ifog {

// Functions that add values throw std::runtime_error with one line if there is no disk space.
template <typename T>
class Column {
 public:
  static_assert(std::is_trivially_copyable_v<T>);
  // Bytes. A dozen columns in memory take 1 % of a small computer's memory.
  static constexpr std::size_t kInMemory = std::size_t{8} << 20U;

  Column() = default;
  explicit Column(std::size_t size, T value = {}) { resize(size, value); }
  explicit Column(std::span<const T> values) {
    reserve(values.size());
    append(values);
  }
  Column(const std::vector<T>& values) : Column(std::span<const T>(values)) {}
  Column(const Column& other) : Column(std::span<const T>(other)) {}
  Column(Column&& other) noexcept { swap(other); }
  Column& operator=(Column other) noexcept {
    swap(other);
    return *this;
  }
  ~Column() = default;

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] const T* data() const { return data_; }
  [[nodiscard]] T* data() { return data_; }
  [[nodiscard]] const T* begin() const { return data_; }
  [[nodiscard]] const T* end() const { return data_ + size_; }
  [[nodiscard]] T* begin() { return data_; }
  [[nodiscard]] T* end() { return data_ + size_; }
  [[nodiscard]] T operator[](std::size_t i) const { return data_[i]; }
  [[nodiscard]] T& operator[](std::size_t i) { return data_[i]; }
  [[nodiscard]] T front() const { return data_[0]; }
  [[nodiscard]] T back() const { return data_[size_ - 1]; }
  friend bool operator==(const Column& one, const Column& other) { return std::ranges::equal(one, other); }

  // True if so many more values need neither memory nor a write to the file.
  [[nodiscard]] bool has_room(std::size_t values) const { return values <= room_ - size_; }
  // Announces the number of values, before the first is added.
  void reserve(std::size_t size) {
    if (size * sizeof(T) > kInMemory && !file_)
      file(size * sizeof(T));
    else if (size > room_ && !file_)
      allocate(size);
  }
  void push_back(T value) {
    if (size_ == room_) grow();
    data_[size_++] = value;
  }
  // values: not of this column.
  void append(std::span<const T> values) {
    while (!values.empty()) {
      if (size_ == room_) grow();
      const std::size_t count = std::min(values.size(), room_ - size_);
      std::copy_n(values.begin(), count, end());
      size_ += count;
      values = values.subspan(count);
    }
  }
  void resize(std::size_t size, T value = {}) {
    if (size_ == 0) reserve(size);
    while (size_ < size) {
      if (size_ == room_) grow();
      const std::size_t end = std::min(size, room_);
      std::fill(data_ + size_, data_ + end, value);
      size_ = end;
    }
    size_ = size;
  }
  // Drops all values but begin … end − 1.
  void keep(std::size_t begin, std::size_t end) {
    if (begin > 0) std::copy(data_ + begin, data_ + end, data_);
    size_ = end - begin;
  }

 private:
  struct Free {
    void operator()(T* at) const { std::free(at); }
  };

  void swap(Column& other) noexcept {
    std::swap(memory_, other.memory_);
    std::swap(file_, other.file_);
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(room_, other.room_);
  }

  void grow() {
    constexpr std::size_t kFirst = 64;
    if (!file_) {
      if (2 * room_ * sizeof(T) <= kInMemory) return allocate(std::max(kFirst, 2 * room_));
      file(2 * room_ * sizeof(T));
      if (size_ < room_) return;
    }
    file_->extend();
    use_file();
  }

  void allocate(std::size_t room) {
    T* const grown = static_cast<T*>(std::realloc(memory_.get(), room * sizeof(T)));
    if (grown == nullptr) throw std::bad_alloc();
    (void)memory_.release();
    memory_.reset(grown);
    data_ = grown;
    room_ = room;
  }

  // Moves the values to a file of about this size.
  void file(std::size_t bytes) {
    file_ = std::make_unique<MappedFile>(bytes);
    const std::unique_ptr<T, Free> before = std::move(memory_);
    const std::span<const T> values(before.get(), std::exchange(size_, 0));
    use_file();
    append(values);
  }

  void use_file() {
    data_ = reinterpret_cast<T*>(file_->data());
    room_ = file_->size() / sizeof(T);
  }

  std::unique_ptr<T, Free> memory_;
  std::unique_ptr<MappedFile> file_;  // used instead of memory_ if there is one
  T* data_ = nullptr;
  std::size_t size_ = 0, room_ = 0;  // values that there are, and that fit
};

using Samples = Column<double>;

}  // namespace ifog
