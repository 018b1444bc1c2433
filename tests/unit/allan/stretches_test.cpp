// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/stretches.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace ifog {
namespace {

// Stamps of 100 Hz that are off by up to `jitter_s` either way, without the samples behind each of `holes`.
std::vector<double> stamps(double jitter_s, const std::vector<int>& holes, int missing, unsigned seed,
                           double start_s) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> off(-jitter_s, jitter_s);
  std::vector<double> out;
  auto hole = holes.begin();
  for (int n = 0; n < 20000; ++n) {
    out.push_back(start_s + n * 0.01 + off(engine));
    if (hole != holes.end() && *hole == n) {
      n += missing;
      ++hole;
    }
  }
  return out;
}

TEST(SampleClock, StampsThatScatterAreNoGaps) {
  for (const double start_s : {0.0, 1.7e9}) {
    for (const double jitter_s : {0.0, 1e-3, 3e-3, 4e-3, 4.9e-3}) {
      const SampleClock clock = sample_clock(stamps(jitter_s, {}, 0, 1, start_s));
      EXPECT_EQ(clock.gaps, 0U) << jitter_s;
      EXPECT_NEAR(clock.period_s, 0.01, 1e-6) << jitter_s;
    }
  }
}

TEST(SampleClock, HolesAmongStampsThatScatterAreFound) {
  const std::vector<int> holes{0, 100, 5000, 5020, 12000, 19990};
  for (const double jitter_s : {0.0, 1e-3, 3e-3, 4e-3}) {
    for (const int missing : {2, 3, 50}) {
      const std::vector<double> time =
          stamps(jitter_s, missing < 10 ? holes : std::vector<int>{100, 5000, 12000}, missing, 2, 0.0);
      const SampleClock clock = sample_clock(time);
      EXPECT_EQ(clock.gaps, missing < 10 ? holes.size() : 3U) << jitter_s << ' ' << missing;
      EXPECT_NEAR(clock.period_s, 0.01, 2e-6) << jitter_s << ' ' << missing;
      EXPECT_EQ(stretches(time, std::vector<double>(time.size(), 1.0), clock).size(), clock.gaps + 1);
    }
  }
}

}  // namespace
}  // namespace ifog
