// SPDX-License-Identifier: Apache-2.0
// Destination of encoded messages; an interface for tests without network.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "drivers/system/fd.h"

namespace ifog {

class Publisher {
 public:
  virtual ~Publisher() = default;
  // Hot path: no allocation, no exception. False: not sent; the caller counts it.
  virtual bool publish(const char* channel, std::span<const std::uint8_t> message) noexcept = 0;
};

// Raw LCM publisher, which does not allocate (unlike the typed one). One per thread, since an lcm_t locks.
// Throws std::runtime_error with one line if LCM rejects the URL.
std::unique_ptr<Publisher> make_lcm_publisher(const std::string& url);

// Claims an LCM channel for as long as the descriptor is open, because listeners cannot distinguish two
// publishers on one channel (several daemons may read one CAN bus or capture). nullopt: another process of this
// network namespace has it.
std::optional<Fd> claim_channel(const std::string& lcm_url, const std::string& channel);

}  // namespace ifog
