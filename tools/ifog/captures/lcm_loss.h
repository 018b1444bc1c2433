// SPDX-License-Identifier: Apache-2.0
// What LCM, which promises nothing, lost on the way from the daemon to here, by the numbers of the messages.
#pragma once

#include <algorithm>
#include <cstdint>
#include <ifog/rate_t.hpp>

namespace ifog::tools {

class LcmLoss {
 public:
  // The messages of one sensor, in order. Returns how many are missing before this one.
  std::int64_t take(const rate_t& message) {
    // A number passed over without the daemon's own gap flag or a merge was lost on the way.
    const bool told = (message.flags & rate_t::FLAG_GAP) != 0 || (message.flags & rate_t::FLAG_MERGED) != 0;
    const std::int64_t lost =
        last_seq_ < 0 || told ? 0 : std::max<std::int64_t>(0, message.seq - last_seq_ - 1);
    last_seq_ = message.seq;
    lost_ += lost;
    return lost;
  }
  [[nodiscard]] std::int64_t lost() const { return lost_; }

 private:
  std::int64_t last_seq_ = -1, lost_ = 0;
};

}  // namespace ifog::tools
