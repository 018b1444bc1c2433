// SPDX-License-Identifier: Apache-2.0
// Names of the states of status_t, for the daemon's log and `ifog monitor`.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <ifog/status_t.hpp>

namespace ifog {

inline const char* state_name(std::int32_t state) {
  constexpr std::array names{"starting", "running", "no data", "device gone", "ended", "failed"};
  static_assert(names.size() == status_t::STATE_FAILED + 1);
  return state >= 0 && state <= status_t::STATE_FAILED ? names[static_cast<std::size_t>(state)] : "unknown";
}

}  // namespace ifog
