// SPDX-License-Identifier: Apache-2.0
// Numbers in texts, held against the C library's own reading.
#include "drivers/ifog/decimal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

namespace {

// NaN: no number, or not all of it.
double all_of(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = ifog::read_decimal(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : std::nan("");
}

TEST(Decimal, StopsWhereTheNumberDoes) {
  for (const char* text : {"1.5e", "1.5e+", "1.5e-x", "1.5,2", "1.5.2", "1.5 ", "-1.5E"}) {
    double value = 0.0;
    const char* const last = text + std::strlen(text);
    const auto [end, error] = ifog::read_decimal(text, last, value);
    EXPECT_EQ(error, std::errc()) << text;
    EXPECT_EQ(std::abs(value), 1.5) << text;
    EXPECT_EQ(std::string(end, last), std::string(text).substr(text[0] == '-' ? 4 : 3)) << text;
  }
}

TEST(Decimal, WhatIsTooSmallIsZero) {
  for (const std::string& text :
       std::vector<std::string>{"1e-400", "0.0001e-330", "123456789e-400", "1e-99999999999999999999",
                                "-1e-400", "2e-324", "0." + std::string(400, '0') + "1"}) {
    EXPECT_EQ(all_of(text), 0.0) << text;
    EXPECT_EQ(std::signbit(all_of(text)), text.front() == '-') << text;
  }
}

TEST(Decimal, WhatIsTooLargeIsNoNumber) {
  for (const std::string& text : std::vector<std::string>{"1e400", "-1e400", "0.0001e+320",
                                                          "1e99999999999999999999", std::string(400, '9')})
    EXPECT_TRUE(std::isnan(all_of(text))) << text;
}

TEST(Decimal, OnePlusSignMayLead) {
  EXPECT_EQ(all_of("+1.5"), 1.5);
  EXPECT_EQ(all_of("+1e-400"), 0.0);
  for (const char* text : {"+", "++1", "+-1", "-+1", "", "x", "1x", " 1", "1 ", "0x10", "1,5"})
    EXPECT_TRUE(std::isnan(all_of(text))) << text;
}

}  // namespace
