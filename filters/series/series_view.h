// SPDX-License-Identifier: Apache-2.0
// Numbers in order that are read in pieces, wherever they are: in memory, or in a file because there are
// more of them than memory is for. What is written against it gives the same figures for both.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace ifog {

class LongSeries;

class SeriesView {
 public:
  SeriesView() = default;
  // What is viewed has to outlive this.
  SeriesView(std::span<const double> values) : values_(values), size_(values.size()) {}
  SeriesView(const std::vector<double>& values) : SeriesView(std::span<const double>(values)) {}
  SeriesView(const LongSeries& values);

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }

  // These numbers: in place where they are in memory, else read into `room`, until that is used again. Throws
  // std::runtime_error with one line where the file cannot be read.
  [[nodiscard]] std::span<const double> piece(std::size_t first, std::size_t count,
                                              std::vector<double>& room) const;
  [[nodiscard]] double at(std::size_t i) const;
  // These numbers, as many as there is room for. Throws likewise.
  void read(std::size_t first, std::span<double> to) const;
  // From begin to end, without what is at `end`.
  [[nodiscard]] SeriesView part(std::size_t begin, std::size_t end) const;
  // All of them at once where they are in memory; empty otherwise.
  [[nodiscard]] std::span<const double> in_memory() const { return values_; }

 private:
  std::span<const double> values_;
  const LongSeries* long_ = nullptr;
  std::size_t first_ = 0;  // of long_
  std::size_t size_ = 0;
};

// How many are read together: they stay in the second-level cache.
inline constexpr std::size_t kSeriesPiece = std::size_t{1} << 14U;

// use(piece, index of its first) for all of [begin, end) in order.
template <typename Use>
void for_each_piece(const SeriesView& series, std::size_t begin, std::size_t end, Use use) {
  std::vector<double> room;
  for (std::size_t at = begin; at < end; at += kSeriesPiece)
    use(series.piece(at, end - at < kSeriesPiece ? end - at : kSeriesPiece, room), at);
}

// For what goes through numbers one by one, in order and from each as far as kAhead: pages of a file are
// looked up together before. Of what is no file's nothing.
class ReadingAhead {
 public:
  explicit ReadingAhead(std::span<const double> values) : values_(values) {}
  // Before the number at i is read, i never decreasing.
  void at(std::size_t i) {
    if (i >= next_) look_up(i);
  }

 private:
  static constexpr std::size_t kAhead = std::size_t{1} << 17U;
  void look_up(std::size_t i);

  std::span<const double> values_;
  std::size_t next_ = 0;
};

// The median of the differences of neighbours, exactly, in memory that does not grow; of an even number the
// upper one. At least two numbers, none NaN, not decreasing.
[[nodiscard]] double median_step(const SeriesView& series);

}  // namespace ifog
