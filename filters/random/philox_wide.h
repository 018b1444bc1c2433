// SPDX-License-Identifier: Apache-2.0
// Philox4x64-10: 64-bit form of the generator in philox.h, from the same paper. It gives twice the bits with
// the same number of multiplications.
#pragma once

#include <array>
#include <cstdint>

namespace ifog {

using WidePhiloxBlock = std::array<std::uint64_t, 4>;
// Keys of the ten rounds.
using WidePhiloxKeys = std::array<std::array<std::uint64_t, 2>, 10>;

[[nodiscard]] constexpr WidePhiloxKeys philox_wide_keys(std::array<std::uint64_t, 2> key) noexcept {
  WidePhiloxKeys keys{};
  for (auto& round : keys) {
    round = key;
    key[0] += 0x9E3779B97F4A7C15U;
    key[1] += 0xBB67AE8584CAA73BU;
  }
  return keys;
}

[[nodiscard]] inline WidePhiloxBlock philox_wide(const WidePhiloxBlock& counter,
                                                 const WidePhiloxKeys& keys) noexcept {
  __extension__ using Product = unsigned __int128;
  // In registers and unrolled: an array rewritten in a loop would stay in memory, at twice the time.
  auto [c0, c1, c2, c3] = counter;
#pragma GCC unroll 10
  for (const auto& key : keys) {
    const Product a = Product{0xD2E7470EE14C6C93U} * c0;
    const Product b = Product{0xCA5A826395121157U} * c2;
    c0 = static_cast<std::uint64_t>(b >> 64U) ^ c1 ^ key[0];
    c1 = static_cast<std::uint64_t>(b);
    c2 = static_cast<std::uint64_t>(a >> 64U) ^ c3 ^ key[1];
    c3 = static_cast<std::uint64_t>(a);
  }
  return {c0, c1, c2, c3};
}

}  // namespace ifog
