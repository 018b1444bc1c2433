// SPDX-License-Identifier: Apache-2.0
// What the daemon writes in front of a recording.
#include "daemon/sensor/flight_header.h"

#include <gtest/gtest.h>

#include <fstream>

#include "drivers/host/driver_instance.h"
#include "tests/unit/own_folder.h"

namespace ifog {
namespace {

// A log's frames go back onto the interface that they came on: by the first that the driver wants.
TEST(RecordedHeader, OfALogOfCandumpTheInterfaceIsKept) {
  const test::OwnFolder folder;
  const std::string log = folder.path("frames.log");
  const DriverInstance driver = make_driver(
      "dbc", {{"dbc", std::string(IFOG_SOURCE_DIR) + "/drivers/dbc/examples/goetting_hg_g_84300.dbc"},
              {"signal", "Angle"},
              {"kind", "angle"}});
  ASSERT_EQ(driver.description().can_ids, 1U);
  std::array<char, 4> id{};
  std::snprintf(id.data(), id.size(), "%03X", driver.description().can_id[0].id);
  std::ofstream(log) << "(1.0) can7 7FF#00\n(1.1) vcan3 " << id.data() << "#0000000000000000\n";
  SensorConfig sensor;
  sensor.name = "nose";
  sensor.driver = "dbc";
  sensor.transport.kind = TransportConfig::Kind::file;
  sensor.transport.candump = true;
  sensor.transport.path = log;
  Config config;
  config.file = "ifogd.toml";
  const auto interface = [&] { return flight_header(sensor, config, driver, "").interface; };
  EXPECT_EQ(interface(), "vcan3");
  sensor.transport.interface = "can1";
  EXPECT_EQ(interface(), "can1");
  sensor.transport.kind = TransportConfig::Kind::can;
  EXPECT_EQ(interface(), "can1");
  sensor.transport.kind = TransportConfig::Kind::file;
  sensor.transport.interface.clear();
  sensor.transport.path = log + ".not-there";
  EXPECT_EQ(interface(), "");
}

}  // namespace
}  // namespace ifog
