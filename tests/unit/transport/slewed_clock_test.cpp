// SPDX-License-Identifier: Apache-2.0
// The arrival clock while NTP slews the system's clocks, and over a sleep of the machine. This program's
// clocks are its own: it is linked with --wrap=clock_gettime.
#include "drivers/transport/clock.h"
#include "tests/unit/test.h"

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
// What the crystal has counted; by how much slewing, a sleep and a setting have moved the clocks on it.
std::int64_t crystal_ns = 1000 * kSecond, slewed_ns = 0, asleep_ns = 0, set_ns = 1'700'000'000 * kSecond;

}  // namespace

extern "C" int __wrap_clock_gettime(clockid_t clock, timespec* time);  // NOLINT(bugprone-reserved-identifier)
extern "C" int __wrap_clock_gettime(clockid_t clock,
                                    timespec* time) {  // NOLINT(bugprone-reserved-identifier)
  std::int64_t ns = crystal_ns;
  if (clock != CLOCK_MONOTONIC_RAW) ns += slewed_ns;
  if (clock == CLOCK_BOOTTIME || clock == CLOCK_REALTIME) ns += asleep_ns;
  if (clock == CLOCK_REALTIME) ns += set_ns;
  *time = {ns / kSecond, ns % kSecond};
  return 0;
}

namespace ifog {
namespace {

TEST(ArrivalClock, IsNotSlewed) {
  const std::int64_t begin = arrival_clock_ns();
  WallShift shift;
  std::int64_t latest = shift.at(begin);
  for (int tenth = 0; tenth < 600; ++tenth) {
    crystal_ns += kSecond / 10;
    slewed_ns += kSecond / 120;  // chrony's most, 8.33 %
    ASSERT_EQ(arrival_clock_ns() - begin, (tenth + 1) * kSecond / 10);
    // Times of day follow in small steps, which are no setting.
    const std::int64_t now = shift.at(arrival_clock_ns());
    ASSERT_NEAR(static_cast<double>(now - latest), static_cast<double>(kSecond / 120), 1e5);
    latest = now;
  }
}

TEST(ArrivalClock, CountsTheTimeAsleep) {
  const std::int64_t begin = arrival_clock_ns();
  asleep_ns += 3600 * kSecond;
  crystal_ns += kSecond / 100;
  EXPECT_EQ(arrival_clock_ns() - begin, 3600 * kSecond + kSecond / 100);
}

TEST(KernelStamps, OfASlewedWallClockArePutWhereTheyWere) {
  KernelStamps stamps;
  stamps.begin(realtime_ns(), arrival_clock_ns());
  for (int n = 0; n < 100; ++n) {
    crystal_ns += kSecond / 10;
    slewed_ns += kSecond / 120;
    const std::int64_t came = arrival_clock_ns(), stamp = realtime_ns();
    crystal_ns += kSecond / 1000;  // until it is read
    stamps.begin(realtime_ns(), arrival_clock_ns());
    EXPECT_NEAR(static_cast<double>(stamps.on_arrival_clock(stamp) - came), 0.0, 1e5);
  }
}

}  // namespace
}  // namespace ifog
