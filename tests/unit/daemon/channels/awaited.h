// SPDX-License-Identifier: Apache-2.0
// What has come of a channel, waited for.
#pragma once

#include "daemon/channels/channel_sources.h"
#include "drivers/transport/clock.h"
#include "tests/unit/test.h"

namespace ifog {

inline constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";

struct Value {
  double value;
  float age_s;
};

inline Value look(const ChannelTable& table) {
  const ChannelValue latest = table.latest(0);
  return {latest.value, latest.age_s(realtime_ns())};
}

// Waits for a value; the test's own time limit ends a wait that would never.
inline Value await(const ChannelTable& table, double value) {
  Value seen = look(table);
  for (int i = 0; i < 2000 && seen.value != value; ++i, seen = look(table))
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return seen;
}

}  // namespace ifog
