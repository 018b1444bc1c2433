// SPDX-License-Identifier: Apache-2.0
// Claims an LCM channel, because listeners cannot distinguish two publishers on one channel (several daemons
// may read one CAN bus or capture). Uses an abstract socket name, which the kernel gives to one process per
// network namespace and releases when that ends.
#pragma once

#include <string>

namespace ifog {

class ChannelClaim {
 public:
  ChannelClaim(const std::string& lcm_url, const std::string& channel);
  ~ChannelClaim();
  ChannelClaim(ChannelClaim&& other) noexcept;
  ChannelClaim(const ChannelClaim&) = delete;
  ChannelClaim& operator=(const ChannelClaim&) = delete;
  ChannelClaim& operator=(ChannelClaim&&) = delete;

  // Another process has it.
  [[nodiscard]] bool in_use() const { return in_use_; }

 private:
  int fd_ = -1;
  bool in_use_ = false;
};

}  // namespace ifog
