// SPDX-License-Identifier: Apache-2.0
// Philox4x32-10, the counter-based generator of Salmon, Moraes, Dror and Shaw, "Parallel random numbers: as
// easy as 1, 2, 3", SC'11. A draw is a function of (key, counter) alone, so a replay that starts anywhere
// gives the same bits. The standard library's engines and distributions promise no such thing across
// versions.
#pragma once

#include <array>
#include <cstdint>

namespace ifog {

using PhiloxBlock = std::array<std::uint32_t, 4>;

[[nodiscard]] PhiloxBlock philox(PhiloxBlock counter, std::array<std::uint32_t, 2> key) noexcept;

}  // namespace ifog
