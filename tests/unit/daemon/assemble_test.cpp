// SPDX-License-Identifier: Apache-2.0
// What the pipelines of several sensors have in common.
#include "daemon/pipeline/assemble.h"

#include <gtest/gtest.h>

#include "tests/unit/daemon/rig.h"

namespace ifog {
namespace {

AssembledSensor reader_on(const std::string& cpus, ReadersProcessors& processors) {
  const Config config = parse_config(R"(
[daemon]
plugin_folder = ")" IFOG_BINARY_DIR R"(/plugins"
[[sensor]]
name = "nose"
driver = "kvh1750"
nominal_rate_hz = 100
[sensor.transport]
type = "serial"
device = "/dev/ttyS1"
[sensor.realtime]
reader_cpus = )" + cpus + "\n",
                                     "f.toml");
  return assemble(config.sensors.at(0), config, std::make_unique<KeepingPublisher>(), processors);
}

// Those that no thread stands back for before so many processors were worked on for three quarters.
void expect_to_be_of(SharedProcessors& shared, int processors) {
  constexpr std::int64_t kWindow = SharedProcessors::kWindow_ns;
  std::int64_t now = kWindow;
  shared.add(now, 0);
  shared.add(now += kWindow, processors * kWindow * 74 / 100);
  EXPECT_LT(shared.quiet_until_ns(), now) << processors;
  shared.add(now += kWindow, processors * kWindow * 76 / 100);
  EXPECT_GT(shared.quiet_until_ns(), now) << processors;
}

// However the configurations name them.
TEST(Assemble, ReadersOnTheSameProcessorsHaveOneAccountOfThem) {
  ReadersProcessors processors;
  const AssembledSensor a = reader_on("[0, 2]", processors), b = reader_on("[2, 0, 2]", processors),
                        c = reader_on("[2]", processors), d = reader_on("[]", processors),
                        e = reader_on("[]", processors);
  const auto account = [](const AssembledSensor& sensor) { return sensor.pipeline->plan().processors; };
  ASSERT_NE(account(a), nullptr);
  EXPECT_EQ(account(a), account(b));
  EXPECT_NE(account(a), account(c));
  ASSERT_NE(account(d), nullptr) << "readers that may run anywhere share all processors";
  EXPECT_EQ(account(d), account(e));
  EXPECT_NE(account(d), account(a));
  EXPECT_EQ(processors.size(), 3U);
  expect_to_be_of(*account(a), 2);
  expect_to_be_of(*account(c), 1);
  expect_to_be_of(*account(d), static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
}

}  // namespace
}  // namespace ifog
