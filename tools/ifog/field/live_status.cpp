// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/field/live_status.h"

#include <poll.h>
#include <sys/socket.h>

#include <ifog/decode.h>
#include <algorithm>
#include <vector>

#include "daemon/state/status_socket.h"
#include "drivers/ifog/quoted.h"
#include "tools/ifog/console/interrupt.h"

namespace ifog::tools {

LiveStatus::LiveStatus(const std::string& folder, pid_t daemon)
    : who_("the daemon (process " + std::to_string(daemon) + ")"), fd_(connect_to_daemon(folder, daemon)) {}

void LiveStatus::take(std::string_view packet) {
  const auto kind = static_cast<StatusPacket>(packet.front());
  packet.remove_prefix(1);
  complete_ = complete_ || kind == StatusPacket::end;
  if (kind == StatusPacket::reload) answer_ = std::string(packet);
  status_t status{};
  if (kind != StatusPacket::status || !decode_message(packet.data(), packet.size(), status)) return;
  all_[status.sensor] = status;
  if (each) each(status);
}

bool LiveStatus::listen(std::chrono::milliseconds most, const std::function<bool()>& enough) {
  using Clock = std::chrono::steady_clock;
  constexpr long kTurn_ms = 500;
  const Clock::time_point end = Clock::now() + most;
  std::vector<char> packet(kLongestStatusPacket);
  while (!enough()) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    if (left <= 0 || gone_ || interrupted()) return false;
    pollfd wanted{fd_, POLLIN, 0};
    if (poll(&wanted, 1, static_cast<int>(std::min<long>(left, kTurn_ms))) <= 0) continue;
    const ssize_t n = ::recv(fd_, packet.data(), packet.size(), 0);
    gone_ = n == 0 || (n < 0 && errno != EINTR);
    if (n > 0) take({packet.data(), static_cast<std::size_t>(n)});
  }
  return true;
}

void LiveStatus::reload(std::chrono::milliseconds most) {
  answer_.reset();
  const char asked = static_cast<char>(StatusPacket::reload);
  if (::send(fd_, &asked, 1, MSG_NOSIGNAL) != 1 || !listen(most, [this] { return answer_.has_value(); }))
    throw std::runtime_error(who_ + (gone_ ? " has ended" : " does not answer"));
  if (!answer_->empty())
    throw std::runtime_error(who_ + " refused to reload: " + printable(*answer_, kLongestMessage));
}

const status_t* LiveStatus::of(const std::string& sensor) const {
  const auto found = all_.find(sensor);
  return found == all_.end() ? nullptr : &found->second;
}

}  // namespace ifog::tools
