// SPDX-License-Identifier: Apache-2.0
// Names of the states of status_t, for the daemon's log and `ifog monitor`.
#pragma once

#include <cstdint>
#include <ifog/status_t.hpp>

namespace ifog {

inline const char* state_name(std::int32_t state) {
  switch (state) {
    case status_t::STATE_STARTING:
      return "starting";
    case status_t::STATE_RUNNING:
      return "running";
    case status_t::STATE_NO_DATA:
      return "no data";
    case status_t::STATE_REOPENING:
      return "device gone";
    case status_t::STATE_ENDED:
      return "ended";
    case status_t::STATE_FAILED:
      return "failed";
    default:
      return "unknown";
  }
}

}  // namespace ifog
