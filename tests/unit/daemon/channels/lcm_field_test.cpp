// SPDX-License-Identifier: Apache-2.0
// Values out of LCM messages, and messages that lie.
#include "daemon/channels/lcm_field.h"

#include <gtest/gtest.h>
#include <ifog/decode.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "tests/unit/messages.h"
#include "tests/unit/refusal.h"

namespace ifog {
namespace {

// Value and time in µs, or NaN where the field does not read the message.
std::pair<double, std::int64_t> read(const std::string& field, const std::vector<std::uint8_t>& message) {
  double value = NAN;
  std::int64_t utime = -1;
  if (!LcmField(field).read(message, value, utime)) return {NAN, -1};
  return {value, utime};
}

TEST(LcmField, ReadsTheThreeTypesByWhatTheyAre) {
  const auto c = encoded(channel("hull_degC", 21.5, 99)), r = encoded(rate()), s = encoded(status());
  using Pair = std::pair<double, std::int64_t>;
  EXPECT_EQ(read("hull_degC", c), Pair(21.5, 99));
  EXPECT_EQ(read("raw[1]", r), Pair(2.0, 7));
  EXPECT_EQ(read("compensated[0]", r), Pair(3.0, 7));
  EXPECT_EQ(read("denoised[1]", r), Pair(6.0, 7));
  EXPECT_EQ(read("clock_offset_ppm", s), Pair(-12.5, 5'000'000));
  EXPECT_EQ(read("latency_p99_us", s), Pair(88.0, 5'000'000));
  EXPECT_EQ(read("measurement_noise[0]", s), Pair(3e-9, 5'000'000));
  // Two seconds old where it was published: as old here.
  EXPECT_EQ(read("channel_value[temperature_degC]", s), Pair(41.5, 3'000'000));
}

// Counts and lengths of a message, each set to what ends a decoder that believes it: 32 bits everywhere, so
// that every count and every length is hit. Each attack ended the daemon, and with it every sensor.
template <typename Message>
void attack(const Message& message, const std::vector<std::string>& fields) {
  const std::vector<std::uint8_t> good = encoded(message);
  for (const std::uint32_t lie : {0xFFFFFFFFU, 0x7FFFFFFFU, 0x80000000U, 0U, 0x00FFFFFFU, 0x02000000U}) {
    for (std::size_t at = 8; at + 4 <= good.size(); ++at) {
      std::vector<std::uint8_t> bad = good;
      for (std::size_t i = 0; i < 4; ++i) bad[at + i] = static_cast<std::uint8_t>(lie >> (24 - 8 * i));
      Message out{};
      if (decode_message(bad, out)) {
        // Only numbers were hit, never a count.
        EXPECT_EQ(static_cast<std::size_t>(out.getEncodedSize()), bad.size()) << at << " " << lie;
      }
      for (const std::string& field : fields) (void)read(field, bad);
    }
  }
  for (std::size_t size = 0; size < good.size(); ++size) {
    Message out{};
    EXPECT_FALSE(decode_message(good.data(), size, out)) << size;
  }
  std::vector<std::uint8_t> longer = good;
  longer.push_back(0);
  Message out{};
  EXPECT_FALSE(decode_message(longer, out));
  EXPECT_TRUE(decode_message(good, out));
}

TEST(DecodeMessage, NoLieInAMessageEndsTheProgram) {
  attack(channel("hull_degC", 21.5), {"hull_degC"});
  attack(rate(), {"raw[0]", "denoised[1]"});
  attack(imu_t{}, {"raw[0]"});
  attack(status(), {"channel_value[supply_V]", "nis_mean[0]", "latency_p99_us", "hull_degC"});
  status_t with_allan = status();
  with_allan.octaves = 3;
  with_allan.allan_rate_radps = {{1.0, 2.0, 3.0}};
  with_allan.fault = "x";
  attack(with_allan, {"channel_value[supply_V]", "nis_mean[0]", "latency_p99_us", "hull_degC"});
}

TEST(DecodeMessage, AnUnknownDefinitionIsNoLayout) {
  EXPECT_THROW(MessageLayout("struct a {\n  other_t x;\n}"), std::invalid_argument);
  EXPECT_THROW(MessageLayout("struct a {\n  double x[n];\n}"), std::invalid_argument);
  EXPECT_NO_THROW(MessageLayout("struct a {\n  int8_t n; // count\n  double x[n];\n}"));
}

TEST(LcmField, WhatAMessageDoesNotHaveIsNotRead) {
  const auto c = encoded(channel("hull_degC", 21.5)), r = encoded(rate()), s = encoded(status());
  for (const auto& [field, message] : {std::pair{"other_degC", c},
                                       {"raw[0]", c},
                                       {"raw[2]", r},
                                       {"hull_degC", r},
                                       {"clock_offset_ppm", r},
                                       {"hull_degC", s},
                                       {"nis_mean[1]", s},
                                       {"channel_value[hull_degC]", s},
                                       // Never measured: an infinite age, not an old value.
                                       {"channel_value[supply_V]", s}})
    EXPECT_TRUE(std::isnan(read(field, message).first)) << field;
  std::vector<std::uint8_t> cut = s;
  cut.resize(cut.size() / 2);
  EXPECT_TRUE(std::isnan(read("clock_offset_ppm", cut).first));
}

TEST(LcmField, RefusesBracketsItDoesNotKnow) {
  for (const char* text : {"raw[3]", "raw[x]", "raw[0", "angle[0]", "channel_value[]", "clock_offset_ppm[0]"})
    EXPECT_EQ(
        test::refusal([&] { LcmField{text}; }).find("sensor.channel.field = \"" + std::string(text) + "\": "),
        0U)
        << text;
}

}  // namespace
}  // namespace ifog
