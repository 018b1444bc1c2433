// SPDX-License-Identifier: Apache-2.0
// The driver to copy: a frame by hand. Its encoder is tried by system/readme, as it is copied.
#include "tests/unit/drivers/decoded.h"
#include "tests/unit/test.h"

namespace {

constexpr double kMicroDegree = 1e-6 * std::numbers::pi / 180.0;

TEST(TemplateDriver, AFrameByHand) {
  ifog::DriverInstance driver = ifog::make_driver("template", {{"mounted", "inverted"}});
  // counter 7, -2 µdeg/s, -5 °C; 0xA5 + 7 + 0xFF + 0xFF + 0xFF + 0xFE + 0xFB = 0x5A2
  const std::vector<ifog_sample> s =
      ifog::decoded(driver, std::vector<std::uint8_t>{0xA5, 7, 0xFF, 0xFF, 0xFF, 0xFE, 0xFB, 0xA2}, 1, 3);
  ASSERT_EQ(s.size(), 1U);
  EXPECT_DOUBLE_EQ(s[0].value[0], 2.0 * kMicroDegree);
  EXPECT_EQ(s[0].sequence, 7U);
  EXPECT_EQ(s[0].environment[0], -5.0);
}

}  // namespace
