// SPDX-License-Identifier: Apache-2.0
// Exponential and uniform deviates by counter: value i of a stream is a function of (seed, stream, i).
//
// 32 bits per deviate suffice: the largest exponential is 22.9, and neighbouring values differ by 2^-32 in
// probability.
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

  // Value `index` of a row. Neighbouring indices are computed together and cached.
  [[nodiscard]] double at(std::uint64_t index, std::uint32_t row) noexcept;

  // Values 0 … out.size()-1 of row `row` at step `index`.
  void fill(std::uint64_t index, std::uint32_t row, std::span<double> out) const noexcept;

 private:
  static constexpr std::size_t kTogether = 8;  // per Philox block

  Law law_;
  WidePhiloxKeys keys_;
  std::uint64_t kept_index_ = ~0ULL;
  std::uint32_t kept_row_ = 0;
  std::array<double, kTogether> kept_{};
};

}  // namespace ifog
