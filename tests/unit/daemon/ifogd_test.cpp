// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/test.h"

// This build's daemon as a user starts it, also where it is built with a sanitizer.
TEST(Ifogd, SaysWhatIsWrong) {
  EXPECT_EQ(std::system("python3 " IFOG_SOURCE_DIR "/tests/system/daemon/words.py " IFOG_BINARY_DIR), 0);
}
