// SPDX-License-Identifier: Apache-2.0
// `ifog monitor` shows what anybody on the network may send: names are shown, never obeyed, and a message
// that is no message of ours is counted.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <ifog/rate_t.hpp>
#include <ifog/status_t.hpp>
#include <lcm/lcm-cpp.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/unit/daemon/private_network.h"

namespace {

constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";

ifog::rate_t rate() {
  ifog::rate_t out{};
  out.axes = 1;
  for (auto* field : {&out.raw, &out.compensated, &out.denoised, &out.variance, &out.delta_theta,
                      &out.covered, &out.angle, &out.innovation, &out.innovation_variance, &out.gain})
    field->push_back(1e-6);
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

std::string text_of(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

TEST(Monitor, ShowsNamesFromTheNetworkAndObeysNone) {
  if (const std::string why = ifog::enter_private_network(); !why.empty())
    GTEST_SKIP() << "no network namespace of its own (" << why << "); run as root";
  const std::string out = ::testing::TempDir() + "monitor_out";
  std::string command = IFOG_BINARY_DIR "/tools/ifog/ifog monitor --seconds 3 --lcm-url '";
  command.append(kUrl).append("' >").append(out).append(" 2>&1");
  int result = -1;
  std::thread monitor([&] { result = std::system(command.c_str()); });
  lcm::LCM lcm(kUrl);
  const ifog::rate_t sample = rate();
  const ifog::status_t health = status();
  // Cut off, and with a number of axes that no vector can have.
  std::vector<unsigned char> broken(static_cast<std::size_t>(sample.getEncodedSize()));
  sample.encode(broken.data(), 0, static_cast<int>(broken.size()));
  constexpr std::size_t kAxesAt = 8 + 5 * 8 + 3 * 4;  // behind the type's hash and what stands before
  ASSERT_EQ(broken[kAxesAt], 1);
  broken[kAxesAt] = 0xFF;
  for (int i = 0; i < 60; ++i) {
    lcm.publish("IFOG_NO\x1b[31mSE,", &sample);
    lcm.publish("IFOG_NO\x1b[31mSE,_STATUS", &health);
    lcm.publish("IFOG_BAD", broken.data(), static_cast<unsigned>(broken.size()));
    lcm.publish("IFOG_BAD_STATUS", broken.data(), 5);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  monitor.join();
  const std::string said = text_of(out);
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
