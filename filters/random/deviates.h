// SPDX-License-Identifier: Apache-2.0
// Exponential and uniform deviates by counter: value number i of a stream is a function of (seed, stream, i)
// alone.
//
// 32 bits a deviate are enough here: the largest exponential is 22.9 and neighbouring values differ by 2^-32
// in probability, far below what a window of a few hundred innovations can show.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "filters/random/philox_wide.h"

namespace ifog {

class DeviateStream {
 public:
  enum class Law { kExponential, kUniform };  // mean 1, and (0, 1)

  DeviateStream(std::uint64_t seed, std::uint64_t stream, Law law)
      : law_(law), keys_(philox_wide_keys({seed, stream})) {}

  // Value number `index` of row `row`. Neighbouring indices are drawn together and kept.
  [[nodiscard]] double at(std::uint64_t index, std::uint32_t row) noexcept;

  // Values 0 … out.size()-1 of the row numbered `index`: fresh weights for one step.
  void fill(std::uint64_t index, std::uint32_t row, std::span<double> out) const noexcept;

 private:
  static constexpr std::size_t kTogether = 8;  // of one Philox block

  Law law_;
  WidePhiloxKeys keys_;
  std::uint64_t kept_index_ = ~0ULL;
  std::uint32_t kept_row_ = 0;
  std::array<double, kTogether> kept_{};
};

}  // namespace ifog
