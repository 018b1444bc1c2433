// SPDX-License-Identifier: Apache-2.0
#include "filters/series/long_series.h"

#include <algorithm>
#include <utility>

#include "filters/series/mapped_file.h"

namespace ifog {

LongSeries::~LongSeries() { unmap(); }

LongSeries::LongSeries(LongSeries&& other) noexcept
    : most_(other.most_),
      recent_(std::exchange(other.recent_, {})),
      filed_(std::exchange(other.filed_, 0)),
      file_(std::exchange(other.file_, std::nullopt)),
      mapped_(std::exchange(other.mapped_, nullptr)) {}

LongSeries& LongSeries::operator=(LongSeries&& other) noexcept {
  std::swap(most_, other.most_);
  std::swap(recent_, other.recent_);
  std::swap(filed_, other.filed_);
  std::swap(file_, other.file_);
  std::swap(mapped_, other.mapped_);
  return *this;
}

std::span<const double> LongSeries::all() {
  if (filed_ == 0) return recent_;
  if (!recent_.empty()) file_recent();
  if (mapped_ == nullptr) mapped_ = static_cast<const double*>(map_file(*file_, filed_ * sizeof(double)));
  return {mapped_, filed_};
}

void LongSeries::unmap() {
  if (mapped_ != nullptr) unmap_file(std::exchange(mapped_, nullptr), filed_ * sizeof(double));
}

void LongSeries::expect(std::size_t numbers) {
  if (numbers <= most_) return recent_.reserve(numbers);
  file_ = take_spare_file(numbers * sizeof(double));
}

void LongSeries::add(double value) {
  recent_.push_back(value);
  if (recent_.size() >= (!file_ ? most_ + 1 : kAtOnce)) file_recent();
}

void LongSeries::add(std::span<const double> values) {
  if (file_ && recent_.empty() && values.size() >= kAtOnce) {
    unmap();
    file_->write(filed_, values);
    filed_ += values.size();
    return;
  }
  recent_.insert(recent_.end(), values.begin(), values.end());
  if (recent_.size() >= (!file_ ? most_ + 1 : kAtOnce)) file_recent();
}

void LongSeries::file_recent() {
  unmap();
  const bool first = !file_;
  if (first) file_.emplace();
  file_->write(filed_, recent_);
  filed_ += recent_.size();
  if (first)
    recent_ = {};  // releases the memory
  else
    recent_.clear();
  recent_.reserve(kAtOnce);
}

void LongSeries::read(std::size_t first, std::span<double> to) const {
  const std::size_t filed = first < filed_ ? std::min(filed_ - first, to.size()) : 0;
  if (filed > 0) file_->read(first, to.first(filed));
  if (filed < to.size())
    std::copy_n(recent_.begin() + static_cast<std::ptrdiff_t>(first + filed - filed_), to.size() - filed,
                to.begin() + static_cast<std::ptrdiff_t>(filed));
}

}  // namespace ifog
