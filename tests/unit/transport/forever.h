// SPDX-License-Identifier: Apache-2.0
// A wait that is over only when what is waited for has come.
#pragma once

#include <chrono>

namespace ifog {

inline constexpr auto kForever = std::chrono::seconds(60);

}  // namespace ifog
