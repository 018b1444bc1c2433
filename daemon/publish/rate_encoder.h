// SPDX-License-Identifier: Apache-2.0
// From the chain's output to the bytes of an ifog.rate_t, in a buffer of its own, without allocation.
#pragma once

#include <cstdint>
#include <ifog/rate_t.hpp>
#include <span>
#include <string>
#include <vector>

#include "filters/chain/signal_chain.h"

namespace ifog {

class RateEncoder {
 public:
  explicit RateEncoder(int axes);

  // Not in the hot path's steady state: allocates when the identity changes (a reload).
  void use(const ChainParts& parts);
  // Valid until the next call.
  std::span<const std::uint8_t> encode(const Increment& in, const ChainOutput& out,
                                       const ChainParts& parts) noexcept;

 private:
  ifog::rate_t message_;
  std::vector<std::uint8_t> buffer_;
};

}  // namespace ifog
