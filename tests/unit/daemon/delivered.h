// SPDX-License-Identifier: Apache-2.0
// A delivery as a transport brings it.
#pragma once

#include "drivers/transport/transport.h"
#include "tests/unit/test.h"

namespace ifog {

inline Delivery delivery(const std::vector<std::uint8_t>& bytes, std::int64_t arrival_ns) {
  Delivery out;
  out.bytes = bytes;
  out.arrival_ns = arrival_ns;
  return out;
}

}  // namespace ifog
