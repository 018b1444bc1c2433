#include <gtest/gtest.h>

#include "drivers/host/driver_instance.h"

namespace {

std::string refusal(const std::string& name, const ifog::DriverSettings& settings) {
  try {
    ifog::make_driver(name, settings);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(DriverHost, FindsThePluginOfTheBuildTree) {
  const ifog::DriverInstance driver = ifog::make_driver("kvh1750", {{"format", "b"}});
  EXPECT_TRUE(driver.takes_bytes());
  EXPECT_EQ(driver.description().axes, 3U);
  EXPECT_EQ(driver.description().has_device_time, 1U);
  EXPECT_STREQ(driver.description().environment[3], "temperature_degC");
}

TEST(DriverHost, NamesKeyValueAndExpectation) {
  EXPECT_EQ(
      refusal("kvh1750", {{"formt", "a"}}),
      "driver kvh1750: unknown option 'formt' (value 'a'), expected one of: format, angle_unit, output, "
      "acceleration, temperature, time_stamp, rate_hz");
  EXPECT_EQ(refusal("kvh1750", {{"format", "d"}}),
            "driver kvh1750: format is 'd', expected one of auto, a, b, c");
  EXPECT_EQ(refusal("kvh1750", {{"rate_hz", "-3"}}),
            "driver kvh1750: rate_hz is '-3', expected a number > 0, at most 100000");
}

}  // namespace
