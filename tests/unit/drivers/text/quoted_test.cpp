// SPDX-License-Identifier: Apache-2.0
// Foreign text in messages: bounded, and nothing a terminal acts on.
#include "drivers/ifog/quoted.h"

#include <gtest/gtest.h>

#include <string>

namespace {

TEST(Quoted, PrintableTextStaysAsItIs) {
  EXPECT_EQ(ifog::in_quotes("rate_radps"), "'rate_radps'");
  EXPECT_EQ(ifog::printable("Grüße, 角速度, °/s, 𝛀"), "Grüße, 角速度, °/s, 𝛀");
  EXPECT_EQ(ifog::printable(""), "");
}

TEST(Quoted, WhatATerminalActsOnIsShown) {
  EXPECT_EQ(ifog::printable("\x1b[31mred\x07\r\n\tend\x7f"), "\\x1b[31mred\\x07\\x0d\\n\\tend\\x7f");
  EXPECT_EQ(ifog::printable(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(ifog::printable("\xC2\x9B"
                            "31m"),
            "\\xc2\\x9b31m");  // CSI as one character, C1
  EXPECT_EQ(ifog::printable("\xE2\x80\xAE"
                            "abc"),
            "\\xe2\\x80\\xaeabc");                                         // right-to-left override
  EXPECT_EQ(ifog::printable("\xE2\x80\xA8"), "\\xe2\\x80\\xa8");           // line separator
  EXPECT_EQ(ifog::printable("\xB0/s"), "\\xb0/s");                         // Latin-1
  EXPECT_EQ(ifog::printable("\xC0\xAF"), "\\xc0\\xaf");                    // overlong '/'
  EXPECT_EQ(ifog::printable("\xED\xA0\x80"), "\\xed\\xa0\\x80");           // a surrogate
  EXPECT_EQ(ifog::printable("\xF4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond U+10FFFF
  EXPECT_EQ(ifog::printable("\xE2\x82"), "\\xe2\\x82");                    // cut off
}

TEST(Quoted, ItsLengthIsBounded) {
  EXPECT_EQ(ifog::printable(std::string(60, 'x')), std::string(60, 'x'));
  EXPECT_EQ(ifog::printable(std::string(61, 'x')), std::string(60, 'x') + "… (61 bytes)");
  EXPECT_EQ(ifog::in_quotes(std::string(500'000'000, '1'), 3), "'111… (500000000 bytes)'");
  EXPECT_LT(ifog::printable(std::string(1000, '\x01')).size(), 90U);
}

}  // namespace
