// SPDX-License-Identifier: Apache-2.0
#include "drivers/system/shell_word.h"
#include "tests/unit/test.h"
#include "tools/ifog/console/progress.h"

namespace {

std::string in_single_quotes(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// What a shell makes of it.
std::string by_a_shell(const std::string& word) {
  std::FILE* const shell = popen(("exec bash -c " + in_single_quotes("printf %s " + word)).c_str(), "r");
  std::string out;
  std::array<char, 256> piece{};
  while (const std::size_t n = fread(piece.data(), 1, piece.size(), shell)) out.append(piece.data(), n);
  pclose(shell);
  return out;
}

TEST(ShellWord, AShellTakesItAsItWas) {
  for (const char* const word : {"plain.csv", "two words.csv", "it's", "''", "a'b'c d", "$HOME `id` \\",
                                 "a\nb", "°", "*", "~", "#a", "!x", "(a)", "x;y&z|w", "\"quoted\"", "{a,b}"})
    EXPECT_EQ(by_a_shell(ifog::shell_word(word)), word);
  EXPECT_EQ(ifog::shell_word(""), "''");
  EXPECT_EQ(ifog::shell_word("a/b_c-1.csv"), "a/b_c-1.csv");
}

// A name that a terminal would act on is printed so that it does not, and still is that name to a shell.
TEST(ShellWord, WhatCannotBeSeenIsCopiedAllTheSame) {
  for (const char* const word : {"a\x1b[31m.csv", "line\nend", "\n", "tab\there", "bell\a7", "it's \x01",
                                 "back\\slash\x7f", "\xff\xfe", "turned\xe2\x80\xae", "° \x1b", "$HOME\r`id`",
                                 "\x1b"
                                 "1"}) {
    const std::string printed = ifog::shell_word(word);
    EXPECT_EQ(by_a_shell(printed), word) << printed;
    EXPECT_EQ(ifog::printable(printed), printed) << "raw control characters in it";
  }
}

TEST(ShellWord, AFileIsNoOption) {
  EXPECT_EQ(ifog::shell_file("-x y.csv"), "'./-x y.csv'");
  EXPECT_EQ(ifog::shell_file("-"), "-");  // standard input
  EXPECT_EQ(ifog::shell_file("a.csv"), "a.csv");
}

using ifog::tools::time_left;

TEST(TimeLeft, TheRestTakesAsLongAsWhatWasDoneTook) {
  EXPECT_EQ(time_left(10.0, 0.0, 1, 2), "10 s left");
  EXPECT_EQ(time_left(10.0, 0.0, 1, 3), "20 s left");
  EXPECT_EQ(time_left(10.0, 0.0, 90, 100), "2 s left");  // 1.1
}

TEST(TimeLeft, WhatHasGoneSinceTheLastStepIsTakenOff) {
  EXPECT_EQ(time_left(10.0, 4.0, 1, 2), "6 s left");
  EXPECT_EQ(time_left(10.0, 10.0, 1, 2), "");  // should have ended
  EXPECT_EQ(time_left(10.0, 25.0, 1, 2), "");
}

TEST(TimeLeft, IsToldAsExactlyAsItIsKnown) {
  EXPECT_EQ(time_left(61.0, 0.0, 1, 2), "65 s left");
  EXPECT_EQ(time_left(100.0, 0.0, 1, 2), "2 min left");
  EXPECT_EQ(time_left(600.0, 0.0, 1, 2), "10 min left");
  EXPECT_EQ(time_left(4800.0, 0.0, 1, 2), "1 h 20 min left");
  EXPECT_EQ(time_left(7200.0, 0.0, 1, 2), "2 h left");
}

TEST(TimeLeft, IsNotGuessedTooEarly) {
  EXPECT_EQ(time_left(1.5, 0.0, 1, 100), "");
  EXPECT_EQ(time_left(1.5, 0.6, 1, 100), "3 min left");  // 147.9 s
  EXPECT_EQ(time_left(1.5, 0.0, 10, 100), "14 s left");  // 13.5
  EXPECT_EQ(time_left(5.0, 0.0, 0, 100), "");
  EXPECT_EQ(time_left(5.0, 0.0, 100, 100), "");
  EXPECT_EQ(time_left(5.0, 0.0, 5, 0), "");
}

}  // namespace
