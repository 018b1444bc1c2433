// SPDX-License-Identifier: Apache-2.0
// What several transports' tests read with. A wait of kForever is over only when what is waited for has come.
#pragma once

#include "drivers/transport/transport.h"
#include "tests/unit/test.h"

namespace ifog {

inline constexpr auto kForever = std::chrono::seconds(60);

inline std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

// Another thread stops the transport while it waits for data.
inline void expect_stop_to_end_a_read(Transport& transport) {
  std::thread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    transport.stop();
  });
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_TRUE(transport.read(kForever).empty());
  EXPECT_LT(std::chrono::steady_clock::now() - begin, kForever / 2);
  stopper.join();
}

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
