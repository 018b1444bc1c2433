// SPDX-License-Identifier: Apache-2.0
// Sequential writer of Samples. Long ones are written in pieces through the file (mapped_file.h).
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "filters/series/mapped_file.h"
#include "filters/series/samples.h"

namespace ifog {

class SamplesWriter {
 public:
  // Throws std::runtime_error with one line if there is no disk space, as do add() and done().
  explicit SamplesWriter(std::size_t size)
      : samples_(Samples::unset(size)),
        filed_(size * sizeof(double) > FiledAllocator<double>::kInMemory),
        piece_(filed_ ? kPiece : 0),
        next_(filed_ ? piece_.data() : samples_.data()),
        end_(next_ + (filed_ ? kPiece : size)) {}
  SamplesWriter(const SamplesWriter&) = delete;
  SamplesWriter& operator=(const SamplesWriter&) = delete;

  void add(double value) {
    *next_++ = value;
    if (next_ == end_ && filed_) file_piece();
  }
  void add(std::span<const double> values) {
    while (!values.empty()) {
      const std::size_t count = std::min(values.size(), static_cast<std::size_t>(end_ - next_));
      next_ = std::copy_n(values.begin(), count, next_);
      if (next_ == end_ && filed_) file_piece();
      values = values.subspan(count);
    }
  }

  // To be called after all values have been added.
  [[nodiscard]] Samples done() && {
    if (filed_) file_piece();
    return std::move(samples_);
  }

 private:
  static constexpr std::size_t kPiece = std::size_t{1} << 15U;

  void file_piece() {
    const auto count = static_cast<std::size_t>(next_ - piece_.data());
    if (count > 0) write_new_file(samples_.data() + written_, piece_.data(), count * sizeof(double));
    written_ += count;
    next_ = piece_.data();
  }

  Samples samples_;
  bool filed_;
  std::vector<double> piece_;
  double *next_, *end_;
  std::size_t written_ = 0;
};

// Copy as Samples.
[[nodiscard]] inline Samples copied(std::span<const double> values) {
  SamplesWriter copy(values.size());
  copy.add(values);
  return std::move(copy).done();
}

}  // namespace ifog
