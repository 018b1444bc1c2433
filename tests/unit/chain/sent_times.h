// SPDX-License-Identifier: Apache-2.0
// When the tests of clocks begin, and how fast their device turns.
#pragma once

#include <cstdint>

namespace ifog {

inline constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;
inline constexpr double kTurning = 0.1;  // rad/s

}  // namespace ifog
