// SPDX-License-Identifier: Apache-2.0
// Lines written by hand from the maker's description of the 100 Hz interface.
#include "drivers/plugins/dsp3000/line.h"
#include "tests/unit/drivers/decoded.h"
#include "tests/unit/test.h"

namespace {

using ifog::decoded;

constexpr double kDegree = std::numbers::pi / 180.0;

TEST(Dsp3000, LinesByHand) {
  ifog::DriverInstance driver = ifog::make_driver("dsp3000", {});
  const std::vector<ifog_sample> s = decoded(driver, "\r\n-12.500000 1\r\n  0.004178 1\r\n359.999999 0\r\n");
  ASSERT_EQ(s.size(), 3U);
  EXPECT_DOUBLE_EQ(s[0].value[0], -12.5 * kDegree);
  EXPECT_EQ(s[0].valid_axes, 1U);
  EXPECT_EQ(s[0].flags, 0U);
  EXPECT_EQ(s[0].arrival_ns, 42);
  EXPECT_DOUBLE_EQ(s[1].value[0], 0.004178 * kDegree);
  EXPECT_DOUBLE_EQ(s[2].value[0], 359.999999 * kDegree);
  EXPECT_EQ(s[2].valid_axes, 0U);
  EXPECT_EQ(driver.counters().frames_good, 3U);
  // The line end in front is what makes the first line one, and no loss.
  EXPECT_EQ(driver.counters().bytes_skipped, 0U);
  EXPECT_EQ(driver.counters().bytes_framed, 3U * 14U + 2U);
  EXPECT_EQ(driver.description().baud, 38400U);
  EXPECT_EQ(driver.description().sequence_modulus, 0U);
}

TEST(Dsp3000, OutputIsWhatTheConfigurationSays) {
  EXPECT_EQ(ifog::make_driver("dsp3000", {{"output", "incremental"}}).description().kind,
            unsigned{IFOG_DELTA_ANGLE});
  const ifog::DriverInstance d =
      ifog::make_driver("dsp3000", {{"output", "integrated"}, {"set_output", "yes"}});
  EXPECT_EQ(d.description().kind, unsigned{IFOG_ANGLE});
  EXPECT_DOUBLE_EQ(d.description().angle_wrap_rad, 360.0 * kDegree);
  EXPECT_EQ(d.description().opening_length, 3U);
  EXPECT_EQ(d.description().opening[0], 'P');
  ifog::DriverInstance reversed = ifog::make_driver("dsp3000", {{"sign", "-1"}});
  EXPECT_DOUBLE_EQ(decoded(reversed, "\n1.000000 1\r\n").at(0).value[0], -kDegree);
}

// The tail of a number is a number: a line is only believed when its beginning was seen.
TEST(Dsp3000, APieceOfALineIsNoReading) {
  ifog::DriverInstance driver = ifog::make_driver("dsp3000", {});
  EXPECT_EQ(decoded(driver, "3.500000 1\r\n").size(), 0U);
  EXPECT_EQ(decoded(driver, "123.500000 1\r\n12").size(), 1U);
  driver.reset();
  EXPECT_EQ(decoded(driver, "3.500000 1\r\n").size(), 0U);
  EXPECT_EQ(driver.counters().frames_format, 0U);
  EXPECT_EQ(driver.counters().bytes_skipped, 11U + 2U + 11U);
}

// As loggers write them: all but the first line, whose beginning nobody saw where no line end precedes it.
TEST(Dsp3000, AnyLineEndIsTaken) {
  for (const std::string end : {"\n", "\r", "\r\n", "\n\n", "\r\r\n", "\n\r"}) {
    ifog::DriverInstance driver = ifog::make_driver("dsp3000", {});
    std::string text;
    for (int i = 0; i < 5; ++i) text += "  1.00000" + std::to_string(i) + " 1" + end;
    const std::vector<ifog_sample> s = decoded(driver, text);
    ASSERT_EQ(s.size(), 4U) << end.size();
    EXPECT_DOUBLE_EQ(s[3].value[0], 1.000004 * kDegree);
    EXPECT_EQ(driver.counters().frames_format, 0U);
    EXPECT_EQ(driver.counters().bytes_framed + driver.counters().bytes_skipped, text.size());
  }
  ifog::DriverInstance datagrams = ifog::make_driver("dsp3000", {});
  std::size_t taken = 0;
  for (int i = 0; i < 5; ++i) taken += decoded(datagrams, "  1.000000 1").size();
  EXPECT_EQ(taken, 4U);
}

TEST(Dsp3000, OnlyTheMakersFormIsAccepted) {
  using ifog::dsp3000::parse_line;
  for (const char* bad :
       {"", "1.00000 1", "1.0000000 1", "1000.000000 1", ".500000 1", "1.000000", "1.000000 2",
        "1.000000 1 1", "--1.000000 1", "1,000000 1", "nan 1", "1.0000001", "+1.000000 1"})
    EXPECT_FALSE(parse_line(bad)) << bad;
  ASSERT_TRUE(parse_line("-0.000001 0"));
  EXPECT_EQ(parse_line("-0.000001 0")->micro_degrees, -1);
}

TEST(Dsp3000, GoodLinesBetweenBadOnesAreKept) {
  std::mt19937 random(3);
  ifog::DriverInstance driver = ifog::make_driver("dsp3000", {});
  std::string text = "\r\n";
  std::vector<double> expected;
  for (int i = 0; i < 3000; ++i) {
    switch (random() % 4) {
      case 0:
        text += std::string(random() % 200, static_cast<char>('A' + random() % 26)) + "\r\n";
        break;
      case 1:
        text += "1.0000" + std::string(1, static_cast<char>(random() % 10)) + "\r\n";
        break;
      default: {
        const int micro = static_cast<int>(random() % 1'999'999'999) - 999'999'999;
        char line[ifog::dsp3000::kLongestLine];
        std::snprintf(line, sizeof line, "%s%d.%06d 1\r\n", micro < 0 ? "-" : "", std::abs(micro) / 1'000'000,
                      std::abs(micro) % 1'000'000);
        text += line;
        expected.push_back(micro * 1e-6 * kDegree);
      }
    }
  }
  std::vector<ifog_sample> s;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t n = 1 + random() % 40;
    for (const ifog_sample& each : decoded(driver, text.substr(at, n))) s.push_back(each);
    at += n;
  }
  ASSERT_EQ(s.size(), expected.size());
  for (std::size_t i = 0; i < s.size(); ++i) EXPECT_NEAR(s[i].value[0], expected[i], 1e-13);
}

TEST(Dsp3000, EncodesWhatItDecodes) {
  ifog::DriverInstance driver = ifog::make_driver("dsp3000", {});
  ifog_sample sample{};
  sample.valid_axes = 1;
  std::vector<std::uint8_t> bytes;
  for (const double degrees : {0.0, -0.000001, 5.25, -123.456789, 999.999999}) {
    sample.value[0] = degrees * kDegree;
    driver.encode_bytes(sample, bytes);
  }
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()),
            "\r\n0.000000 1\r\n-0.000001 1\r\n5.250000 1\r\n-123.456789 1\r\n999.999999 1\r\n");
  // Read back, nothing of it is left over, however it is cut.
  ifog::DriverInstance reader = ifog::make_driver("dsp3000", {});
  std::size_t samples = 0;
  for (const std::uint8_t byte : bytes)
    samples += decoded(reader, std::string(1, static_cast<char>(byte))).size();
  EXPECT_EQ(samples, 5U);
  EXPECT_EQ(reader.counters().bytes_framed, bytes.size());
  EXPECT_EQ(reader.counters().bytes_skipped, 0U);
  sample.value[0] = 1000.0 * kDegree;
  EXPECT_THROW(driver.encode_bytes(sample, bytes), std::runtime_error);
}

}  // namespace
