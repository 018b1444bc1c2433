// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/clock.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kNow = 1'700'000'000 * kSecond;

TEST(WallShift, StaysExactlyTheSameUntilTheClockIsSet) {
  WallShift shift;
  EXPECT_EQ(shift.from(kNow + 20'000, kNow), 0);  // read one after the other
  EXPECT_EQ(shift.from(kNow - 20'000, kNow), 0);
  const std::int64_t back = shift.from(kNow - 5 * kSecond, kNow);
  EXPECT_EQ(back, -5 * kSecond);
  EXPECT_EQ(shift.from(kNow - 5 * kSecond + 30'000, kNow), back);
  // Delayed between the two readings.
  EXPECT_EQ(shift.from(kNow - 5 * kSecond + 900'000, kNow, 880'000), back);
  EXPECT_EQ(shift.from(kNow - 5 * kSecond + 900'000, kNow, 840'000), back + 900'000);
  EXPECT_EQ(shift.from(kNow + 3600 * kSecond, kNow), 3600 * kSecond);
}

// Frames of a bus, one a millisecond, stamped with a wall clock that is set between the frames 40 and 41 and
// read some time later.
std::vector<std::int64_t> read_after_step(std::int64_t step_ns, int read_before) {
  KernelStamps stamps;
  std::vector<std::int64_t> out;
  const auto arrival = [](int n) { return kNow + n * 1'000'000; };
  const auto stamp = [&](int n) { return arrival(n) + (n > 40 ? step_ns : 0); };
  const std::vector<int> reads{read_before, 100};
  stamps.begin(kNow - kSecond, kNow - kSecond);
  int at = 0;
  for (const int read : reads) {
    const std::int64_t now = arrival(read) + 100'000;
    stamps.begin(now + (read > 40 ? step_ns : 0), now);
    for (; at <= read; ++at) out.push_back(stamps.on_arrival_clock(stamp(at)) - arrival(at));
  }
  return out;
}

TEST(KernelStamps, AStepOfTheWallClockMovesNoStamp) {
  for (const std::int64_t step : {-3600 * kSecond, -5 * kSecond, kSecond / 2, 5 * kSecond, 3600 * kSecond}) {
    for (const int read_before : {10, 39, 40, 41, 60}) {
      const std::vector<std::int64_t> wrong = read_after_step(step, read_before);
      for (std::size_t n = 0; n < wrong.size(); ++n)
        EXPECT_EQ(wrong[n], 0) << "step " << step << " frame " << n << " first read after " << read_before;
    }
  }
}

TEST(KernelStamps, IsNeverLaterThanTheReading) {
  KernelStamps stamps;
  stamps.begin(kNow, kNow);
  EXPECT_EQ(stamps.on_arrival_clock(kNow + 10 * kSecond), kNow);
}

TEST(Backlog, ARegularReadIsTimed) {
  Backlog backlog;
  for (std::int64_t at = kNow; at < kNow + kSecond; at += 1'000'000)
    EXPECT_FALSE(backlog.read(at, at + 900'000, 250'000'000));
  EXPECT_FALSE(backlog.read(kNow + kSecond, kNow + kSecond + 260'000'000, 250'000'000)) << "a silence";
}

TEST(Backlog, AfterAReadThatWasLeftOrEnteredLateTimesAreNotKnownUntilItIsThrough) {
  for (const bool entered_late : {false, true}) {
    Backlog backlog;
    ASSERT_FALSE(backlog.read(kNow, kNow + 1'000'000, 250'000'000));
    const std::int64_t entered = kNow + (entered_late ? 4 * kSecond : 2'000'000);
    const std::int64_t left = kNow + 4 * kSecond + 100'000;
    EXPECT_TRUE(backlog.read(entered, left, 250'000'000));
    EXPECT_FALSE(backlog.may_be_over());
    std::int64_t at = left;
    for (; at < left + 100'000'000; at += 1'000'000) {
      EXPECT_TRUE(backlog.read(at, at + 500'000, 250'000'000));
      EXPECT_FALSE(backlog.may_be_over());
    }
    EXPECT_TRUE(backlog.read(at, at + 500'000, 250'000'000));
    EXPECT_TRUE(backlog.may_be_over());
    EXPECT_TRUE(backlog.read(at + 500'000, at + 900'000, 250'000'000)) << "more still waits";
    backlog.over();
    EXPECT_FALSE(backlog.read(at + 1'000'000, at + 1'500'000, 250'000'000));
  }
}

}  // namespace
}  // namespace ifog
