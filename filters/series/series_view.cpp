// SPDX-License-Identifier: Apache-2.0
#include "filters/series/series_view.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "filters/series/long_series.h"
#include "filters/series/mapped_file.h"

namespace ifog {
namespace {

constexpr std::size_t kLookedUp = std::size_t{16} << 20U;  // in bytes

// Calls use(step) for all steps.
template <typename Use>
void for_each_step(const SeriesView& series, Use use) {
  double before = series.at(0);
  for_each_piece(series, 1, series.size(), [&](std::span<const double> values, std::size_t) {
    for (const double now : values) {
      use(now - before);
      before = now;
    }
  });
}

}  // namespace

SeriesView::SeriesView(const LongSeries& values) : long_(&values), size_(values.size()) {
  if (values.filed() > 0) return;
  values_ = values.recent();
  long_ = nullptr;
}

std::span<const double> SeriesView::piece(std::size_t first, std::size_t count,
                                          std::vector<double>& room) const {
  if (long_ == nullptr) {
    const std::span<const double> some = values_.subspan(first, count);
    // So many values are in a file.
    if (values_.size_bytes() > kLookedUp) expect_reading(some.data(), some.size_bytes());
    return some;
  }
  if (room.size() < count) room.resize(count);
  const std::span<double> to(room.data(), count);
  long_->read(first_ + first, to);
  return to;
}

void ReadingAhead::look_up(std::size_t i) {
  next_ = i + kAhead;
  const std::span<const double> some = values_.subspan(i, std::min(kAhead, values_.size() - i));
  if (values_.size_bytes() > kLookedUp) expect_reading(some.data(), some.size_bytes());
}

void SeriesView::read(std::size_t first, std::span<double> to) const {
  if (long_ != nullptr)
    long_->read(first_ + first, to);
  else
    std::copy_n(values_.begin() + static_cast<std::ptrdiff_t>(first), to.size(), to.begin());
}

double SeriesView::at(std::size_t i) const {
  if (long_ == nullptr) return values_[i];
  double value = 0.0;
  long_->read(first_ + i, {&value, 1});
  return value;
}

SeriesView SeriesView::part(std::size_t begin, std::size_t end) const {
  SeriesView out = *this;
  if (long_ == nullptr)
    out.values_ = values_.subspan(begin, end - begin);
  else
    out.first_ = first_ + begin;
  out.size_ = end - begin;
  return out;
}

// Non-negative doubles are ordered like their bits, so the median is found by 16 bits at a time.
double median_step(const SeriesView& series) {
  constexpr unsigned kBits = 16;
  std::size_t rank = (series.size() - 1) / 2;
  std::uint64_t known = 0;
  for (unsigned shift = 64; shift > 0;) {
    const unsigned above = shift;
    shift -= kBits;
    std::vector<std::size_t> count(std::size_t{1} << kBits);
    for_each_step(series, [&](double step) {
      const auto bits = std::bit_cast<std::uint64_t>(std::max(step, 0.0));
      if (above == 64 || (bits ^ known) >> above == 0) ++count[bits >> shift & (count.size() - 1)];
    });
    std::size_t digit = 0;
    while (rank >= count[digit]) rank -= count[digit++];
    known |= static_cast<std::uint64_t>(digit) << shift;
  }
  return std::bit_cast<double>(known);
}

}  // namespace ifog
