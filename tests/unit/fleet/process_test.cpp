// SPDX-License-Identifier: Apache-2.0
// Other programs, run to their end or to the end of patience.
#include "tools/ifog/fleet/process.h"
#include "tests/unit/test.h"

namespace ifog::tools {
namespace {

using namespace std::chrono_literals;

TEST(RunToEnd, GivesWhatTheProgramSaidAndHowItEnded) {
  const Ran echoed = run_to_end({"cat"}, "a\nb\n", 1min);
  EXPECT_EQ(echoed.said, "a\nb\n");
  EXPECT_EQ(echoed.ended, "");
  const Ran failed = run_to_end({"sh"}, "echo no >&2; exit 3", 1min);
  EXPECT_EQ(failed.said, "no\n");
  EXPECT_EQ(failed.ended, "exit 3");
}

// It would be waited for until the test's own time is over.
TEST(RunToEnd, OneThatDoesNotAnswerIsNotWaitedForForEver) {
  const Ran silent = run_to_end({"sh"}, "echo begun; exec sleep 100000", 500ms);
  EXPECT_EQ(silent.ended, "no answer within 0.5 s");
}

// Its end is its own, not that of what it leaves behind with its output.
TEST(RunToEnd, OneThatLeavesItsOutputOpenIsNotWaitedFor) {
  EXPECT_EQ(run_to_end({"sh"}, "sleep 20 & exit 0", 10s).ended, "");
}

}  // namespace
}  // namespace ifog::tools
