// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/field/live_status.h"

#include <ifog/decode.h>
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <thread>

#include "daemon/state/running_mark.h"
#include "drivers/ifog/quoted.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/interrupt.h"

namespace ifog::tools {
namespace {

Statuses decoded(std::string_view answer) {
  Statuses out;
  for (std::uint32_t bytes = 0; answer.size() >= sizeof bytes;) {
    std::memcpy(&bytes, answer.data(), sizeof bytes);
    answer.remove_prefix(sizeof bytes);
    status_t status{};
    if (bytes <= answer.size() && decode_message(answer.data(), bytes, status)) out[status.sensor] = status;
    answer.remove_prefix(std::min<std::size_t>(bytes, answer.size()));
  }
  return out;
}

}  // namespace

bool LiveStatus::ask(std::chrono::milliseconds most, const std::function<bool(const Statuses&)>& enough) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kBetween{500};  // half of the period of status messages
  const Clock::time_point end = Clock::now() + most;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
    all_ = decoded(ask_daemon(folder_, daemon_, DaemonQuestion::status, std::max(left, 4 * kBetween)));
    if (enough(all_)) return true;
    if (left.count() <= 0 || interrupted()) return false;
    std::this_thread::sleep_for(std::min(left, kBetween));
  }
}

void LiveStatus::reload(std::chrono::milliseconds most) const {
  const std::string refused = ask_daemon(folder_, daemon_, DaemonQuestion::reload, most);
  if (!refused.empty())
    throw refusal("the daemon refused to reload: {}", printable(refused, kLongestMessage));
}

const status_t* LiveStatus::of(const std::string& sensor) const {
  const auto found = all_.find(sensor);
  return found == all_.end() ? nullptr : &found->second;
}

}  // namespace ifog::tools
