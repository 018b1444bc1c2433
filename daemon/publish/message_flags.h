// SPDX-License-Identifier: Apache-2.0
// The flags of rate_t and imu_t, from what the chain found.
#pragma once

#include <cstdint>

#include "filters/chain/signal_chain.h"

namespace ifog {

std::int32_t message_flags(const Increment& in, const ChainOutput& out) noexcept;

}  // namespace ifog
