// SPDX-License-Identifier: Apache-2.0
// Vector of numbers per sample: small ones in memory, large ones in an unnamed file. Works like std::vector.
#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <new>
#include <span>
#include <utility>
#include <vector>

#include "filters/series/mapped_file.h"

namespace ifog {

// Allocates memory for small vectors and a mapped file for large ones. Throws std::runtime_error with one
// line if there is no disk space.
template <typename T>
struct FiledAllocator {
  using value_type = T;
  static constexpr std::size_t kInMemory = std::size_t{16} << 20U;  // bytes per vector

  FiledAllocator() = default;
  // unset: elements are not initialised.
  explicit FiledAllocator(bool unset) : unset_(unset) {}
  template <typename Other>
  FiledAllocator(const FiledAllocator<Other>&) {}

  [[nodiscard]] T* allocate(std::size_t n) {
    if (n > std::numeric_limits<std::size_t>::max() / sizeof(T)) throw std::bad_alloc();
    const std::size_t bytes = n * sizeof(T);
    return static_cast<T*>(bytes <= kInMemory ? ::operator new(bytes) : map_new_file(bytes));
  }
  void deallocate(T* at, std::size_t n) noexcept {
    if (n * sizeof(T) <= kInMemory)
      ::operator delete(at);
    else
      unmap_new_file(at, n * sizeof(T));
  }
  template <typename Other, typename... Arguments>
  void construct(Other* at, Arguments&&... arguments) {
    if (sizeof...(Arguments) > 0 || !unset_)
      ::new (static_cast<void*>(at)) Other(std::forward<Arguments>(arguments)...);
  }
  [[nodiscard]] FiledAllocator select_on_container_copy_construction() const { return FiledAllocator(); }
  friend bool operator==(const FiledAllocator&, const FiledAllocator&) { return true; }

 private:
  bool unset_ = false;
};

template <typename T>
using FiledVector = std::vector<T, FiledAllocator<T>>;

class Samples : public FiledVector<double> {
 public:
  using FiledVector<double>::FiledVector;
  Samples() = default;
  Samples(const std::vector<double>& values) : Samples(values.begin(), values.end()) {}
  explicit Samples(std::span<const double> values) : Samples(values.begin(), values.end()) {}

  // Uninitialised samples, all to be written (samples_writer.h).
  [[nodiscard]] static Samples unset(std::size_t size) {
    Samples samples;
    static_cast<FiledVector<double>&>(samples) = FiledVector<double>(size, FiledAllocator<double>(true));
    return samples;
  }

  friend bool operator==(const Samples& one, const Samples& other) { return std::ranges::equal(one, other); }
};

}  // namespace ifog
