// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/console/options/help_text.h"

#include <gtest/gtest.h>

namespace {

using ifog::tools::broken_lines;

TEST(HelpText, WhatIsTooLongGoesOnBelowWhereItsColumnBegins) {
  EXPECT_EQ(broken_lines("  --from N  leave out what is before\n", 12, 24),
            "  --from N  leave out\n            what is\n            before\n");
  EXPECT_EQ(broken_lines("  --from N  leave out\n", 12, 24), "  --from N  leave out\n");
  // An option that is too wide for its column has its description below.
  EXPECT_EQ(broken_lines("  --long-option N\n            what it is good for\n", 12, 24),
            "  --long-option N\n            what it is\n            good for\n");
  EXPECT_EQ(broken_lines("what the whole command does with all of it\n", 12, 24),
            "what the whole command\ndoes with all of it\n");
}

TEST(HelpText, LettersCountAndNotBytes) {
  EXPECT_EQ(broken_lines("  --spin N  µ µ µ µ µ µ\n", 12, 23), "  --spin N  µ µ µ µ µ µ\n");
}

TEST(HelpText, WhatCannotBeBrokenStaysWhole) {
  EXPECT_EQ(broken_lines("  --from N  abcdefghijklmnopqrstuvw x\n", 12, 24),
            "  --from N  abcdefghijklmnopqrstuvw\n            x\n");
  EXPECT_EQ(broken_lines("  ifog convert gyro.csv gyro.kvh --driver kvh1750\n", 12, 24),
            "  ifog convert gyro.csv gyro.kvh --driver kvh1750\n");
}

TEST(HelpText, NoTwoEmptyLinesFollow) { EXPECT_EQ(broken_lines("a\n\n\nb\n", 12, 24), "a\n\nb\n"); }

}  // namespace
