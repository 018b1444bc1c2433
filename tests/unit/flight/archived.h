// SPDX-License-Identifier: Apache-2.0
// The times of a test archive, and the numbers of what is read back from it.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <vector>

#include "tests/unit/flight/recordings.h"

namespace ifog {

inline constexpr std::int64_t kSecond = 1'000'000'000, kDay = 86'400 * kSecond;
inline constexpr std::int64_t kWall = 1'700'000'000 * kSecond;  // 2023-11-14T22:13:20Z

inline std::vector<std::uint64_t> numbers(const ReadBack& read) {
  std::vector<std::uint64_t> out;
  for (const auto& payload : read.payloads) {
    out.emplace_back();
    std::memcpy(&out.back(), payload.data(), 8);
    EXPECT_EQ(payload, numbered(out.back()));
  }
  return out;
}

inline std::vector<std::uint64_t> counting(std::uint64_t from, std::uint64_t to) {
  std::vector<std::uint64_t> out;
  for (; from < to; ++from) out.push_back(from);
  return out;
}

}  // namespace ifog
