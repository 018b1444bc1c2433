// SPDX-License-Identifier: Apache-2.0
// Philox4x32-10, counter-based generator of Salmon, Moraes, Dror and Shaw, "Parallel random numbers: as easy
// as 1, 2, 3", SC'11. A number is a function of (key, counter), so a replay from any point gives the same
// bits, unlike the standard library's engines and distributions across versions.
#pragma once

#include <array>
#include <cstdint>

namespace ifog {

using PhiloxBlock = std::array<std::uint32_t, 4>;

[[nodiscard]] PhiloxBlock philox(PhiloxBlock counter, std::array<std::uint32_t, 2> key) noexcept;

}  // namespace ifog
