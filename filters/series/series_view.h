// SPDX-License-Identifier: Apache-2.0
// View of a number sequence in memory or in a file, read in pieces. Analyses that use it give the same
// results for both.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace ifog {

class LongSeries;

class SeriesView {
 public:
  SeriesView() = default;
  // The viewed data must outlive this object.
  SeriesView(std::span<const double> values) : values_(values), size_(values.size()) {}
  SeriesView(const std::vector<double>& values) : SeriesView(std::span<const double>(values)) {}
  SeriesView(const LongSeries& values);

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }

  // These numbers: in place if in memory, else read into `room` (valid until it is used again). Throws
  // std::runtime_error with one line if the file cannot be read.
  [[nodiscard]] std::span<const double> piece(std::size_t first, std::size_t count,
                                              std::vector<double>& room) const;
  [[nodiscard]] double at(std::size_t i) const;
  // Reads to.size() numbers. Throws likewise.
  void read(std::size_t first, std::span<double> to) const;
  // The range begin … end − 1.
  [[nodiscard]] SeriesView part(std::size_t begin, std::size_t end) const;
  // All values if they are in memory, else empty.
  [[nodiscard]] std::span<const double> in_memory() const { return values_; }

 private:
  std::span<const double> values_;
  const LongSeries* long_ = nullptr;
  std::size_t first_ = 0;  // in long_
  std::size_t size_ = 0;
};

// Values read at a time; they fit into the second-level cache.
inline constexpr std::size_t kSeriesPiece = std::size_t{1} << 14U;

// Calls use(piece, index of its first value) for all of [begin, end) in order.
template <typename Use>
void for_each_piece(const SeriesView& series, std::size_t begin, std::size_t end, Use use) {
  std::vector<double> room;
  for (std::size_t at = begin; at < end; at += kSeriesPiece)
    use(series.piece(at, end - at < kSeriesPiece ? end - at : kSeriesPiece, room), at);
}

// For sequential access that reads up to kAhead values beyond each position: prefetches pages of a file. No
// effect on values in memory.
class ReadingAhead {
 public:
  explicit ReadingAhead(std::span<const double> values) : values_(values) {}
  // To be called before value i is read; i must not decrease.
  void at(std::size_t i) {
    if (i >= next_) look_up(i);
  }

 private:
  static constexpr std::size_t kAhead = std::size_t{1} << 17U;
  void look_up(std::size_t i);

  std::span<const double> values_;
  std::size_t next_ = 0;
};

// Exact median of the differences of neighbours, in constant memory; of an even number the upper one. Needs
// two values or more, not decreasing, without NaN.
[[nodiscard]] double median_step(const SeriesView& series);

}  // namespace ifog
