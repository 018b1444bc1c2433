// SPDX-License-Identifier: Apache-2.0
#include "filters/series/median_step.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ifog {

// Non-negative doubles are ordered like their bits, so the median is found by 16 bits at a time.
double median_step(std::span<const double> series) {
  constexpr unsigned kBits = 16;
  std::size_t rank = (series.size() - 1) / 2;
  std::uint64_t known = 0;
  for (unsigned shift = 64; shift > 0;) {
    const unsigned above = shift;
    shift -= kBits;
    std::vector<std::size_t> count(std::size_t{1} << kBits);
    for (std::size_t i = 1; i < series.size(); ++i) {
      const auto bits = std::bit_cast<std::uint64_t>(std::max(series[i] - series[i - 1], 0.0));
      if (above == 64 || (bits ^ known) >> above == 0) ++count[bits >> shift & (count.size() - 1)];
    }
    std::size_t digit = 0;
    while (rank >= count[digit]) rank -= count[digit++];
    known |= static_cast<std::uint64_t>(digit) << shift;
  }
  return std::bit_cast<double>(known);
}

}  // namespace ifog
