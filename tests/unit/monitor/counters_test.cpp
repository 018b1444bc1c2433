// SPDX-License-Identifier: Apache-2.0
// The list of counters against the message's own definition.
#include "msgs/counters.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

TEST(StatusCounters, AreThoseOfTheMessageInItsOrder) {
  std::ifstream file(IFOG_SOURCE_DIR "/msgs/status_t.lcm");
  std::vector<std::string> defined;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string type, name;
    words >> type >> name;
    if (type == "int64_t" && name != "utime;" && name != "model_since;")
      defined.push_back(name.substr(0, name.find(';')));
  }
  ASSERT_GT(defined.size(), 40U);
  std::vector<std::string> listed;
  ifog::status_t message{};
  std::int64_t value = 0;
  for (const ifog::StatusCounter& each : ifog::kStatusCounters) {
    listed.emplace_back(each.name);
    message.*each.count = ++value;
  }
  EXPECT_EQ(listed, defined);
  // Each is a field of its own.
  value = 0;
  for (const ifog::StatusCounter& each : ifog::kStatusCounters)
    EXPECT_EQ(message.*each.count, ++value) << each.name;
}
