// SPDX-License-Identifier: Apache-2.0
#include "filters/random/deviates.h"

#include <algorithm>
#include <cstring>

#include "filters/random/inverse_law.h"

namespace ifog {
namespace {

// Third word of the counter, for the two uses.
enum Use : std::uint64_t { kSingle, kRow };

// Two deviates per 64 bits.
void to_law(DeviateStream::Law law, std::span<const std::uint64_t> bits, double* out) noexcept {
  const auto put = [&out](DoublePair pair) {
    std::memcpy(out, &pair, sizeof pair);
    out += 2;
  };
  if (law == DeviateStream::Law::kExponential) {
    for (const std::uint64_t word : bits) put(exponential_deviates(word));
  } else {
    for (const std::uint64_t word : bits) put(uniform_deviates(word));
  }
}

}  // namespace

double DeviateStream::at(std::uint64_t index, std::uint32_t row) noexcept {
  const std::uint64_t together = index / kTogether;
  if (together != kept_index_ || row != kept_row_) {
    to_law(law_, philox_wide({together, row, kSingle, 0}, keys_), kept_.data());
    kept_index_ = together;
    kept_row_ = row;
  }
  return kept_[index % kTogether];
}

// First all bits, then all deviates, so that the processor need not wait for the rounds of each block.
void DeviateStream::fill(std::uint64_t index, std::uint32_t row, std::span<double> out) const noexcept {
  constexpr std::size_t kBlocks = 8;
  std::array<std::uint64_t, 4 * kBlocks> bits;
  std::uint64_t block = 0;
  while (!out.empty()) {
    const std::size_t count = std::min(out.size(), kBlocks * kTogether);
    const std::size_t blocks = (count + kTogether - 1) / kTogether;
    for (std::size_t b = 0; b < blocks; ++b) {
      const auto [w0, w1, w2, w3] = philox_wide({index, row, kRow, block++}, keys_);
      bits[4 * b] = w0, bits[4 * b + 1] = w1, bits[4 * b + 2] = w2, bits[4 * b + 3] = w3;
    }
    const std::size_t whole = count / 2;
    to_law(law_, {bits.data(), whole}, out.data());
    if (count % 2 != 0) {
      std::array<double, 2> last;
      to_law(law_, {bits.data() + whole, 1}, last.data());
      out[count - 1] = last[0];
    }
    out = out.subspan(count);
  }
}

}  // namespace ifog
