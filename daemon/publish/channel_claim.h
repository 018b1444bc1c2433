// SPDX-License-Identifier: Apache-2.0
// A source may be read by many: a CAN bus, a capture. But what two daemons publish on one LCM channel, none
// who listens can tell apart. So each holds a name for its channel that the kernel gives to one process of a
// network namespace only, and gives back when that ends, however it does.
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

  // Another process holds it.
  [[nodiscard]] bool taken() const { return taken_; }

 private:
  int fd_ = -1;
  bool taken_ = false;
};

}  // namespace ifog
