// SPDX-License-Identifier: Apache-2.0
// The driver to copy does what its comment promises: frames by hand, split and damaged streams, encode and
// decode.
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

TEST(TemplateDriver, KeepsEveryIntactFrameAroundDamage) {
  ifog::DriverInstance driver = ifog::make_driver("template", {});
  std::vector<std::uint8_t> bytes;
  ifog_sample sample{};
  sample.valid_axes = 1;
  for (std::uint32_t i = 0; i < 50; ++i) {
    sample.sequence = i;
    sample.value[0] = i * 1e-3;
    driver.encode_bytes(sample, bytes);
    if (i % 5 == 0) bytes.insert(bytes.end(), {0xA5, 1, 2, 0xA5, 0xA5});  // torsos
  }
  for (const std::size_t portion : {std::size_t{1}, std::size_t{7}, bytes.size()}) {
    ifog::DriverInstance fresh = ifog::make_driver("template", {});
    const std::vector<ifog_sample> s = ifog::decoded(fresh, bytes, 1, portion);
    ASSERT_EQ(s.size(), 50U);
    for (std::uint32_t i = 0; i < 50; ++i) EXPECT_NEAR(s[i].value[0], i * 1e-3, kMicroDegree);
    EXPECT_EQ(fresh.counters().frames_good, 50U);
    EXPECT_EQ(fresh.counters().bytes_skipped, 50U);
  }
}

}  // namespace
