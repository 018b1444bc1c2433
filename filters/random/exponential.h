// Exponential and uniform deviates by counter: value number i of a stream is a function of (seed, stream, i)
// alone.
//
// Philox lanes of 32 bits are enough here: the largest exponential is 22.9 and neighbouring values differ by
// 2^-32 in probability, far below what a window of a few hundred innovations can show.
#pragma once

#include <cstdint>
#include <span>

#include "filters/random/philox.h"

namespace ifog {

class DeviateStream {
 public:
  enum class Law { kExponential, kUniform };  // mean 1, and (0, 1)

  DeviateStream(std::uint64_t seed, std::uint32_t stream, Law law) : law_(law), stream_(stream) {
    key_ = {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U)};
  }

  // Value number `index` of row `row`. Neighbouring indices share a Philox block, which is kept.
  [[nodiscard]] double at(std::uint64_t index, std::uint32_t row) noexcept;

  // Values 0 … out.size()-1 of the row numbered `index`: fresh weights for one step.
  void fill(std::uint64_t index, std::uint32_t row, std::span<double> out) const noexcept;

 private:
  [[nodiscard]] double deviate(std::uint32_t bits) const noexcept;

  Law law_;
  std::uint32_t stream_;
  std::array<std::uint32_t, 2> key_{};
  std::uint64_t kept_block_ = ~0ULL;
  std::uint32_t kept_row_ = 0;
  PhiloxBlock kept_{};
};

}  // namespace ifog
