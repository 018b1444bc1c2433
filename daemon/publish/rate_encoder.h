// SPDX-License-Identifier: Apache-2.0
// Encodes the chain's output as ifog.rate_t in its own buffer, without allocation.
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

  // Allocates if the identity changes (a reload).
  void use(const ChainParts& parts);
  // Valid until the next call.
  std::span<const std::uint8_t> encode(const Increment& in, const ChainOutput& out,
                                       const ChainParts& parts) noexcept;

 private:
  ifog::rate_t message_;
  std::vector<std::uint8_t> buffer_;
};

}  // namespace ifog
