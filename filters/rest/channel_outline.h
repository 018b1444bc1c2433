// SPDX-License-Identifier: Apache-2.0
// Summary of a channel of any length by at most 4096 means, enough for the slow effect of temperature on
// rate.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace ifog {

class ChannelOutline {
 public:
  static constexpr std::size_t kMostMeans = 4096;

  explicit ChannelOutline(std::string name) : name_(std::move(name)) {}

  [[nodiscard]] const std::string& name() const { return name_; }
  // Rows per mean, a power of two.
  [[nodiscard]] std::size_t rows() const { return rows_; }
  // Mean of each `rows()` rows from the first row on, in the channel's unit; NaN where a group has no value.
  // An incomplete last group is dropped.
  [[nodiscard]] const std::vector<double>& means() const { return means_; }

  void add(std::span<const double> values) {
    for (const double value : values) {
      if (!std::isnan(value)) sum_ += value, ++known_;
      if (++open_ < rows_) continue;
      means_.push_back(known_ > 0 ? sum_ / static_cast<double>(known_) : kNone);
      sum_ = 0.0, known_ = open_ = 0;
      if (means_.size() == kMostMeans) halve();
    }
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  void halve() {
    for (std::size_t i = 0; i < kMostMeans / 2; ++i) {
      const double a = means_[2 * i], b = means_[2 * i + 1];
      means_[i] = std::isnan(a) ? b : std::isnan(b) ? a : 0.5 * (a + b);
    }
    means_.resize(kMostMeans / 2);
    rows_ *= 2;
  }

  std::string name_;
  std::size_t rows_ = 1, open_ = 0, known_ = 0;  // open_: rows since the last mean
  double sum_ = 0.0;
  std::vector<double> means_;
};

}  // namespace ifog
