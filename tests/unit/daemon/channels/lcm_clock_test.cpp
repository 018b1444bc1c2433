// SPDX-License-Identifier: Apache-2.0
// Channels from a computer whose clock is behind.
#include <gtest/gtest.h>
#include <lcm/lcm.h>

#include <chrono>
#include <ifog/channel_t.hpp>
#include <memory>
#include <thread>
#include <vector>

#include "daemon/channels/channel_sources.h"
#include "drivers/transport/clock.h"
#include "tests/unit/daemon/private_network.h"

namespace ifog {
namespace {

using namespace std::chrono_literals;

constexpr const char* kClockUrl = "udpm://239.255.76.67:7667?ttl=0";

// Each value is new and all seem to be an hour old: that is the clock's, and they are fresh.
TEST(ChannelSources, AValueFromAComputerWhoseClockIsBehindIsFresh) {
  if (const std::string why = enter_private_network(); !why.empty())
    GTEST_SKIP() << "no private network namespace (" << why << "); runs as root or with user namespaces";
  ChannelConfig one;
  one.name = "coil_degC";
  one.source = ChannelConfig::Source::lcm;
  one.lcm_channel = "HULL";
  const auto hull = std::make_shared<ChannelTable>(1);
  ChannelSources sources({{one, hull, 0}}, kClockUrl);
  sources.start();
  lcm_t* const lcm = lcm_create(kClockUrl);
  ASSERT_NE(lcm, nullptr);
  for (int n = 0; n < 5; ++n) {
    channel_t message{};
    message.utime = realtime_ns() / 1000 - 3'600'000'000;
    message.name = one.name;
    message.value = 20.0 + n;
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    lcm_publish(lcm, "HULL", bytes.data(), static_cast<unsigned>(bytes.size()));
    for (int wait = 0; wait < 1000 && hull->latest(0).value != message.value; ++wait)
      std::this_thread::sleep_for(5ms);
    EXPECT_EQ(hull->latest(0).value, message.value);
  }
  EXPECT_LT(hull->latest(0).age_s(arrival_clock_ns()), 10.0F);
  EXPECT_EQ(
      describe(one, hull->fault(0)),
      "channel 'coil_degC': LCM channel 'HULL': the clock that dates it is 3600 s behind this computer's: "
      "ages are counted from the newest that has come");
  lcm_destroy(lcm);
}

}  // namespace
}  // namespace ifog
