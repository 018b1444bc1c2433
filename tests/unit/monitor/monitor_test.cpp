// SPDX-License-Identifier: Apache-2.0
// `ifog monitor` shows what anybody on the network may send: names are shown, never obeyed, and a message
// that is no message of ours is counted.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <ifog/rate_t.hpp>
#include <ifog/status_t.hpp>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <thread>
#include <vector>

#include "tests/unit/daemon/private_network.h"
#include "tests/unit/messages.h"
#include "tests/unit/own_folder.h"

namespace {

constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";

ifog::rate_t sample() {
  ifog::rate_t out = ifog::rate(1);
  out.model = "\x1b]52;c;aWZvZw==\x07";  // writes the terminal's clipboard
  return out;
}

ifog::status_t status() {
  ifog::status_t out{};
  out.axes = 1;
  out.nis_mean = out.whiteness = out.measurement_noise = {1.0};
  out.channels = 1;
  out.channel_name = {
      "temp\x1b[2J\x9b"
      "31m\nX_degC"};
  out.channel_value = {20.0};
  out.channel_age_s = {0.1};
  out.allan_rate_radps.resize(1);
  out.fault = "gone\r\x1b[1A";
  out.frames_read = 60;
  out.frames_good = 50;
  out.frames_format = 7;
  out.frames_other = 3;
  out.samples_in = 50;
  out.samples_published = 46;
  out.samples_merged = 2;
  out.lcm_failures = out.samples_waiting = out.channel_drops = 1;
  out.kernel_drops = 11;
  return out;
}

TEST(Monitor, ShowsNamesFromTheNetworkAndObeysNone) {
  if (const std::string why = ifog::enter_private_network(); !why.empty())
    GTEST_SKIP() << "no network namespace of its own (" << why << "); run as root";
  const ifog::test::OwnFolder folder;
  std::string command = IFOG_BINARY_DIR "/tools/ifog/ifog monitor --seconds 3 --lcm-url '";
  command.append(kUrl).append("' >").append(folder.path("out")).append(" 2>&1");
  int result = -1;
  std::thread monitor([&] { result = std::system(command.c_str()); });
  lcm::LCM lcm(kUrl);
  const ifog::rate_t one = sample();
  const ifog::status_t health = status();
  // Cut off, and with a number of axes that no vector can have.
  std::vector<std::uint8_t> broken = ifog::encoded(one);
  constexpr std::size_t kAxesAt = 8 + 5 * 8 + 3 * 4;  // behind the type's hash and what stands before
  ASSERT_EQ(broken[kAxesAt], 1);
  broken[kAxesAt] = 0xFF;
  for (int i = 0; i < 60; ++i) {
    lcm.publish("IFOG_NO\x1b[31mSE,", &one);
    lcm.publish("IFOG_NO\x1b[31mSE,_STATUS", &health);
    lcm.publish("IFOG_BAD", broken.data(), static_cast<unsigned>(broken.size()));
    lcm.publish("IFOG_BAD_STATUS", broken.data(), 5);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  monitor.join();
  const std::string said = folder.content("out");
  EXPECT_EQ(result, 0) << said;
  for (const char c : said)
    EXPECT_TRUE(c == '\n' ||
                (static_cast<unsigned char>(c) >= 0x20 && c != 0x7F && static_cast<unsigned char>(c) != 0x9B))
        << static_cast<int>(c) << " in\n"
        << said;
  for (const char* part : {"NO\\x1b[31mSE,  ", "temp\\x1b[2J\\x9b31m\\nX_degC 20", "gone\\x0d\\x1b[1A",
                           "kernel drops 11", "channel messages dropped 1",
                           "books: 60 CAN frames = 50 decoded + 7 refused + 3 not the sensor's; 50 samples = "
                           "46 published + 2 merged + 1 not sent + 1 waiting",
                           "model \\x1b]52", "messages that are none of ours"})
    EXPECT_NE(said.find(part), std::string::npos) << part << " is not in\n" << said;
}

}  // namespace
