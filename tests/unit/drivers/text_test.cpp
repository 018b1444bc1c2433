// SPDX-License-Identifier: Apache-2.0
// Numbers in texts, held against the C library's own reading.
#include "drivers/ifog/decimal.h"
#include "drivers/ifog/nearest.h"
#include "drivers/ifog/quoted.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

// NaN: no number, or not all of it.
double all_of(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = read_decimal(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : std::nan("");
}

TEST(Decimal, StopsWhereTheNumberDoes) {
  for (const char* text : {"1.5e", "1.5e+", "1.5e-x", "1.5,2", "1.5.2", "1.5 ", "-1.5E"}) {
    double value = 0.0;
    const char* const last = text + std::strlen(text);
    const auto [end, error] = read_decimal(text, last, value);
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

// The name that may have been meant. Distances by hand.

TEST(Nearest, TheFirstOfTheNearestAndNothingThatIsFar) {
  const std::vector<std::string> names{"denoise", "diagnose", "drivers", "tune"};
  EXPECT_EQ(did_you_mean("denoize", names), ", did you mean 'denoise'?");
  EXPECT_EQ(did_you_mean("dignose", names), ", did you mean 'diagnose'?");
  EXPECT_EQ(did_you_mean("tnue", names), ", did you mean 'tune'?");
  EXPECT_EQ(did_you_mean("plot", names), "");
  EXPECT_EQ(did_you_mean("t", names), "");  // of one letter anything could be meant
  EXPECT_EQ(did_you_mean("", names), "");
  EXPECT_EQ(did_you_mean(std::string(1000, 'd'), names), "");
}

TEST(Nearest, AValueThatIsNoneOfItsWordsIsToldAllAndTheNear) {
  const std::vector<std::string> words{"overlapping", "modified"};
  EXPECT_EQ(one_of("overlaping", words), "one of overlapping, modified; did you mean 'overlapping'?");
  EXPECT_EQ(one_of("total", words), "one of overlapping, modified");
  EXPECT_EQ(one_of("modifed", words, ", or both"),
            "one of overlapping, modified, or both; did you mean 'modified'?");
}

// Foreign text in messages: bounded, and nothing a terminal acts on.

TEST(Quoted, PrintableTextStaysAsItIs) {
  EXPECT_EQ(in_quotes("rate_radps"), "'rate_radps'");
  EXPECT_EQ(printable("Grüße, 角速度, °/s, 𝛀"), "Grüße, 角速度, °/s, 𝛀");
  EXPECT_EQ(printable(""), "");
}

TEST(Quoted, WhatATerminalActsOnIsShown) {
  EXPECT_EQ(printable("\x1b[31mred\x07\r\n\tend\x7f"), "\\x1b[31mred\\x07\\x0d\\n\\tend\\x7f");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("\xC2\x9B"
                      "31m"),
            "\\xc2\\x9b31m");  // CSI as one character, C1
  EXPECT_EQ(printable("\xE2\x80\xAE"
                      "abc"),
            "\\xe2\\x80\\xaeabc");                                   // right-to-left override
  EXPECT_EQ(printable("\xE2\x80\xA8"), "\\xe2\\x80\\xa8");           // line separator
  EXPECT_EQ(printable("\xB0/s"), "\\xb0/s");                         // Latin-1
  EXPECT_EQ(printable("\xC0\xAF"), "\\xc0\\xaf");                    // overlong '/'
  EXPECT_EQ(printable("\xED\xA0\x80"), "\\xed\\xa0\\x80");           // a surrogate
  EXPECT_EQ(printable("\xF4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond U+10FFFF
  EXPECT_EQ(printable("\xE2\x82"), "\\xe2\\x82");                    // cut off
}

TEST(Quoted, ItsLengthIsBounded) {
  EXPECT_EQ(printable(std::string(60, 'x')), std::string(60, 'x'));
  EXPECT_EQ(printable(std::string(61, 'x')), std::string(60, 'x') + "… (61 bytes)");
  EXPECT_EQ(in_quotes(std::string(500'000'000, '1'), 3), "'111… (500000000 bytes)'");
  EXPECT_LT(printable(std::string(1000, '\x01')).size(), 90U);
}

}  // namespace
}  // namespace ifog
