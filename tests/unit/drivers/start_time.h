// SPDX-License-Identifier: Apache-2.0
// When the timelines of the tests begin.
#pragma once

#include <cstdint>

namespace ifog {

inline constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;

}  // namespace ifog
