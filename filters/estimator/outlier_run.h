// SPDX-License-Identifier: Apache-2.0
// A measurement far from where the filter at rest expects it: an outlier, or the first of a jump. The next
// ones tell, and how many it takes depends on how rare outliers are.
//
// Each far measurement in a row speaks for a jump by -ln(share of samples that are far). Noise that has just
// become louder is far again and again, too, but not in the same place: a jump's measurements are as close to
// each other as the noise, and the logarithm of that ratio is to be above half that of the filter's lag, in
// which a jump would otherwise be followed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "filters/estimator/change_test.h"

namespace ifog {

class OutlierRun {
 public:
  static constexpr std::size_t kMost = 64;

  // lag: of the filter at rest, samples.
  void take(const Surprise& now, double lag) noexcept;

  // By the last measurement: it is to be kept out; it and those before it in a row are a jump.
  [[nodiscard]] bool keep_out() const noexcept { return keep_out_; }
  [[nodiscard]] bool jump() const noexcept { return jump_; }
  // It is the first of those in a row.
  [[nodiscard]] bool began() const noexcept { return began_; }
  // The far ones in a row, the last one included, oldest first.
  [[nodiscard]] std::span<const Axes> run() const noexcept { return {run_.data(), length_}; }
  // The run was dealt with as a jump.
  void clear() noexcept { length_ = 0; }
  void restart() noexcept {
    length_ = 0;
    keep_out_ = jump_ = began_ = false;
  }
  // What one measurement may count for, nats: no more than far ones are rare.
  [[nodiscard]] double most() const noexcept { return most_; }

 private:
  void count(bool far) noexcept;
  void fill(std::uint32_t valid) noexcept;

  std::array<Axes, kMost> run_{};
  std::size_t length_ = 0;
  std::uint32_t measured_ = 0;  // axes that one of the run at least has
  std::uint32_t far_axes_ = 0;  // that are far in one of them
  double apart_ = 0.0;          // sum of the logarithms of distance from rest over distance from each other
  double squares_ = 0.0;        // of the distances from rest, normalised
  double share_ = 1e-8;         // of samples that are far
  double samples_ = 0.0;
  double most_ = 12.5;
  std::size_t waited_ = 0;  // samples since one had an axis that is far
  bool keep_out_ = false, jump_ = false, began_ = false;
};

}  // namespace ifog
