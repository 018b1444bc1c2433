// SPDX-License-Identifier: Apache-2.0
// Where encoded messages go. An interface, so that tests need no network.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace ifog {

class Publisher {
 public:
  virtual ~Publisher() = default;
  // Hot path: no allocation, no exception. False: not sent; the caller counts it.
  virtual bool publish(const char* channel, std::span<const std::uint8_t> message) noexcept = 0;
};

// Raw LCM publishing, which does not allocate (the typed one does at every send). One a thread: an lcm_t
// locks inside. Throws std::runtime_error with one line: a URL that LCM refuses.
std::unique_ptr<Publisher> make_lcm_publisher(const std::string& url);

}  // namespace ifog
