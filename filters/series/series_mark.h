// SPDX-License-Identifier: Apache-2.0
// What tells a series from every other one, in one pass over it.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "filters/series/mapped_file.h"

namespace ifog {

// A digest of every bit of a series: two that differ have the same once in 2^128.
struct SeriesMark {
  std::size_t size = 0;
  std::array<std::uint64_t, 4> lanes{};
  friend bool operator==(const SeriesMark&, const SeriesMark&) = default;
};

inline SeriesMark mark_of(std::span<const double> series) noexcept {
  constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15U;  // of the golden ratio: it spreads every bit
  SeriesMark mark{series.size(), {1, 2, 3, 4}};
  std::size_t i = 0;
  const auto take = [&](std::uint64_t& lane, double value) {
    lane = std::rotl((lane ^ std::bit_cast<std::uint64_t>(value)) * kOdd, 31);
  };
  constexpr std::size_t kPiece = std::size_t{1} << 17U;
  while (i + 4 <= series.size()) {
    const std::size_t end = std::min(i + kPiece, series.size() / 4 * 4);
    expect_reading(series.data() + i, (end - i) * sizeof(double));
    for (; i < end; i += 4)
      for (std::size_t lane = 0; lane < 4; ++lane) take(mark.lanes[lane], series[i + lane]);
  }
  for (; i < series.size(); ++i) take(mark.lanes[i % 4], series[i]);
  return mark;
}

}  // namespace ifog
