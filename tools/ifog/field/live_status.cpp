// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/field/live_status.h"

#include <poll.h>

#include <ifog/decode.h>
#include <algorithm>

#include "tools/ifog/console/interrupt.h"

namespace ifog::tools {

LiveStatus::LiveStatus(const std::string& lcm_url)
    : listener_(lcm_url, [this](const lcm_recv_buf_t& message, const std::string&) {
        status_t status{};
        // One that is none of ours is passed over.
        if (!decode_message(message.data, message.data_size, status)) return;
        all_[status.sensor] = status;
        if (each) each(status);
      }) {
  listener_.listen_to("IFOG_.*_STATUS");
}

bool LiveStatus::listen(std::chrono::milliseconds most, const std::function<bool()>& enough) {
  using Clock = std::chrono::steady_clock;
  constexpr long kTurn_ms = 500;
  const Clock::time_point end = Clock::now() + most;
  pollfd wanted{listener_.descriptor(), POLLIN, 0};
  while (!enough()) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    if (left <= 0 || interrupted()) return false;
    if (poll(&wanted, 1, static_cast<int>(std::min<long>(left, kTurn_ms))) > 0) listener_.take();
  }
  return true;
}

const status_t* LiveStatus::of(const std::string& sensor) const {
  const auto found = all_.find(sensor);
  return found == all_.end() ? nullptr : &found->second;
}

}  // namespace ifog::tools
