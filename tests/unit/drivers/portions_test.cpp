// SPDX-License-Identifier: Apache-2.0
// A line that collects frames for nearly a round of their counter and hands them on together: what is lost or
// changes places around such a pause is no round, and none is made of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "drivers/ifog/device_timeline.h"

namespace ifog {
namespace {

enum class Happens { lost, exchanged, moved };

struct Collected {
  std::int64_t modulus = 128;
  double rate_hz = 1000.0, portion_s = 0.1;
  Happens happens = Happens::lost;
  bool constant = false;  // the gyro measures the same all along
};

struct Counted {
  std::int64_t missing = 0, late = 0;
};

// The numbers of the frames in the order in which they come, in two of a hundred places another than their
// own.
std::vector<std::int64_t> order(Happens happens, std::mt19937_64& random) {
  std::vector<std::int64_t> out;
  const auto any = [&](int least, int most) { return std::uniform_int_distribution(least, most)(random); };
  for (std::int64_t n = 0; n < 30000; ++n) {
    if (n <= 200 || any(0, 49) != 0) {
      out.push_back(n);
      continue;
    }
    const int by = happens == Happens::exchanged ? 1 : any(2, 4);
    if (happens == Happens::lost) {
      n += by - 1;
      continue;
    }
    for (int i = 1; i <= by; ++i) out.push_back(n + i);
    out.push_back(n);
    n += by;
  }
  return out;
}

class Collecting : public testing::TestWithParam<Collected> {};

TEST_P(Collecting, MakesNoRounds) {
  const Collected& line = GetParam();
  std::mt19937_64 random(11);
  DeviceTimeline timeline(static_cast<std::uint64_t>(line.modulus), line.rate_hz);
  Counted told, truth;
  std::int64_t furthest = -1, latest_ns = 0;
  for (const std::int64_t n : order(line.happens, random)) {
    const double taken_s = static_cast<double>(n) / line.rate_hz;
    const double portion = std::floor(taken_s / line.portion_s);
    const double comes_s = (portion + 1.0) * line.portion_s + 1e-3 * (taken_s - portion * line.portion_s);
    latest_ns = std::max(latest_ns + 1000, static_cast<std::int64_t>((1.0 + comes_s) * 1e9));
    const double value = line.constant ? 0.5 : 0.1 * std::sin(0.0157 * static_cast<double>(n));
    DeviceTimeline::Frame frame;
    frame.counts = true;
    frame.sequence = static_cast<std::uint32_t>(n % line.modulus);
    frame.arrival_ns = latest_ns;
    frame.values = {&value, 1};
    if (furthest < 0) {
      timeline.first(frame);
      furthest = n;
      continue;
    }
    const DeviceTimeline::Step step = timeline.next(frame);
    ASSERT_FALSE(step.restarted) << "sample " << n;
    if (step.out_of_turn)
      ++told.late;
    else
      told.missing += static_cast<std::int64_t>(step.samples) - 1;
    if (n < furthest) {
      ++truth.late;
    } else {
      truth.missing += n - furthest - 1;
      furthest = n;
    }
  }
  EXPECT_EQ(told.missing, truth.missing);
  EXPECT_EQ(told.late, truth.late);
}

std::vector<Collected> lines() {
  std::vector<Collected> out;
  for (const Happens happens : {Happens::lost, Happens::exchanged, Happens::moved})
    for (const bool constant : {false, true}) {
      out.push_back({128, 1000.0, 0.1, happens, constant});
      out.push_back({256, 1000.0, 0.2, happens, constant});
      out.push_back({128, 200.0, 0.1, happens, constant});
    }
  return out;
}

std::string name_of(const testing::TestParamInfo<Collected>& of) {
  const Collected& line = of.param;
  const std::string happens = line.happens == Happens::lost        ? "Lost"
                              : line.happens == Happens::exchanged ? "Exchanged"
                                                                   : "Moved";
  return happens + (line.constant ? "Constant" : "") + "Of" + std::to_string(line.modulus) + "At" +
         std::to_string(static_cast<int>(line.rate_hz)) + "Hz";
}

INSTANTIATE_TEST_SUITE_P(Lines, Collecting, testing::ValuesIn(lines()), name_of);

// Two gyros whose portions of half a round come in turn over one line.
TEST(Collecting, FromTwoDevicesIsStillSeen) {
  DeviceTimeline timeline(128, 1000.0);
  bool mixed = false;
  for (std::int64_t portion = 0; portion < 60; ++portion)
    for (std::int64_t i = 0; i < 2 * 64; ++i) {
      const bool second = i >= 64;
      const std::int64_t n = portion * 64 + i % 64 + (second ? 70 : 5);
      const double value = (second ? 1.0 : 0.0) + 1e-6 * static_cast<double>(n);
      DeviceTimeline::Frame frame;
      frame.counts = true;
      frame.sequence = static_cast<std::uint32_t>(n % 128);
      frame.arrival_ns = 1'000'000'000 + (portion + 1) * 64'000'000 + i * 1000;
      frame.values = {&value, 1};
      if (portion == 0 && i == 0)
        timeline.first(frame);
      else
        timeline.next(frame);
      mixed = mixed || timeline.mixed();
    }
  EXPECT_TRUE(mixed);
}

}  // namespace
}  // namespace ifog
