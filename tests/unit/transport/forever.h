// SPDX-License-Identifier: Apache-2.0
// What several transports' tests read with. A wait of kForever is over only when what is waited for has come.
#pragma once

#include "drivers/transport/transport.h"
#include "tests/unit/test.h"

namespace ifog {

inline constexpr auto kForever = std::chrono::seconds(60);

// At least so many bytes; `restarted` becomes true where a delivery says so.
inline std::string read_some(Transport& transport, std::size_t n, bool* restarted = nullptr) {
  std::string text;
  while (text.size() < n && !transport.stopped()) {
    const Delivery d = transport.read(kForever);
    if (restarted != nullptr) *restarted = *restarted || d.restarted;
    text.append(d.bytes.begin(), d.bytes.end());
  }
  return text;
}

}  // namespace ifog
