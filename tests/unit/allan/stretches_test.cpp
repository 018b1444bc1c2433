// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/stretches.h"
#include "filters/allan/confidence.h"
#include "filters/allan/deviation.h"
#include "filters/allan/noise/noise_coefficients.h"
#include "filters/allan/theo1.h"
#include "filters/rest/rest.h"
#include "tests/unit/test.h"
#include "tools/simulate/noise.h"

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

TEST(SampleClock, StampsThatScatterAreNoGapsAndHolesAmongThemAreFound) {
  EXPECT_EQ(sample_clock(stamps(4.9e-3, {}, 0, 1, 0.0)).gaps, 0U);
  for (const double jitter_s : {0.0, 1e-3, 3e-3, 4e-3}) {
    for (const int missing : {0, 1, 2, 3, 50}) {
      const std::vector<int> holes = missing == 0   ? std::vector<int>{}
                                     : missing < 10 ? std::vector<int>{0, 100, 5000, 5020, 12000, 19990}
                                                    : std::vector<int>{100, 5000, 12000};
      const std::vector<double> time = stamps(jitter_s, holes, missing, 2, missing == 0 ? 1.7e9 : 0.0);
      const SampleClock clock = sample_clock(time);
      EXPECT_EQ(clock.gaps, holes.size()) << jitter_s << ' ' << missing;
      EXPECT_NEAR(clock.period_s, 0.01, 2e-6) << jitter_s << ' ' << missing;
      EXPECT_EQ(stretches(time, std::vector<double>(time.size(), 1.0), clock).size(), clock.gaps + 1);
    }
  }
}

// Single samples lost at random, as a line loses them: each is found, however close the next one is.
TEST(SampleClock, SamplesLostAtRandomAmongStampsThatScatterAreFound) {
  for (const double jitter : {0.05, 0.2, 0.3, 0.4}) {
    for (const double lost : {0.001, 0.01, 0.02, 0.05, 0.1}) {
      std::mt19937_64 engine(11);
      std::uniform_real_distribution<double> uniform;
      std::vector<double> time;
      std::size_t gaps = 0, missing = 0;
      bool hole = false;
      for (int n = 0; n < 50000; ++n) {
        if (n > 5 && n < 49990 && uniform(engine) < lost) {
          ++missing;
          hole = true;
          continue;
        }
        time.push_back((n + jitter * (2.0 * uniform(engine) - 1.0)) * 0.01);
        gaps += hole ? 1U : 0U;
        hole = false;
      }
      const SampleClock clock = sample_clock(time);
      EXPECT_EQ(clock.gaps, gaps) << jitter << ' ' << lost;
      EXPECT_EQ(clock.missing, missing) << jitter << ' ' << lost;
      EXPECT_EQ(clock.first_gap, holes(time, clock).front().after);
      // Nearly without scatter, a hole's length is dropped as measured, with the jitter of its two stamps.
      EXPECT_NEAR(clock.period_s, 0.01, jitter < 0.1 ? 2e-6 : 2e-7) << jitter << ' ' << lost;
    }
  }
}

// 400 Hz in stamps of whole milliseconds: steps of 2 and of 3, as many of one as of the other.
TEST(SampleClock, OfCoarseStampsALostSampleIsFoundWhereverItIs) {
  for (const int samples : {20000, 20001}) {
    for (const int lost : {5, 10, 15, 100, 5000}) {
      std::vector<double> time;
      for (int n = 0; n < samples; ++n)
        if (n != lost) time.push_back(1e-3 * (5 * n / 2));
      const SampleClock clock = sample_clock(time);
      EXPECT_TRUE(clock.scatters());
      EXPECT_EQ(clock.gaps, 1U) << samples << ' ' << lost;
      EXPECT_EQ(clock.missing, 1U) << samples << ' ' << lost;
      EXPECT_NEAR(clock.period_s, 2.5e-3, 1e-7) << samples << ' ' << lost;
    }
  }
}

// Single precision at 1e5 s tells times of 1/128 s apart: an even 100 Hz then has steps of one such tick and
// of two, and no sample is lost; the record's length is then known to one tick. Of a device that has a sample
// in each tick and loses one in four by chance, they are lost.
TEST(SampleClock, StampsInTicksOfMoreThanHalfAPeriodAreNoGaps) {
  for (const double hertz : {68.0, 97.3, 100.0, 122.0}) {
    std::vector<double> time;
    for (int n = 0; n < 20000; ++n) time.push_back(static_cast<double>(static_cast<float>(1e5 + n / hertz)));
    const SampleClock clock = sample_clock(time);
    EXPECT_NEAR(clock.period_s * 19999, 19999 / hertz, 1.0 / 128.0) << hertz;
    EXPECT_EQ(clock.gaps, 0U) << hertz;
  }
  std::mt19937_64 engine(7);
  std::vector<double> time;
  std::size_t lost = 0;
  for (int n = 0; n < 20000; ++n) {
    if (n > 0 && n < 19999 && engine() % 4 == 0)
      ++lost;
    else
      time.push_back(n / 128.0);
  }
  const SampleClock clock = sample_clock(time);
  EXPECT_NEAR(clock.period_s * 128.0, 1.0, 1e-9);
  EXPECT_EQ(clock.missing, lost);
}

// Stamps of an even clock that are late by jitter and, after its host has stalled, by the queue.
std::vector<double> late_stamps(double period_s, double jitter_s, double stall_s) {
  std::mt19937_64 engine(13);
  std::uniform_real_distribution<double> off(0.0, jitter_s);
  std::vector<double> out{0.0};
  for (int n = 1; n < 20000; ++n) {
    const double queued_s = n < 9000 ? 0.0 : std::max(0.0, stall_s - 0.1 * period_s * (n - 9000));
    out.push_back(std::max(out.back() + 0.3 * period_s, n * period_s + queued_s + off(engine)));
  }
  return out;
}

// A car's log at 50 Hz whose host stalls for 1.7 s: 11 to 36 ms between stamps, and no sample is lost.
TEST(SampleClock, ADelayThatReturnsIsNoGap) {
  const SampleClock clock = sample_clock(late_stamps(0.02, 0.016, 1.7));
  EXPECT_EQ(clock.gaps, 0U);
  EXPECT_NEAR(clock.period_s, 0.02, 2e-6);
}

// A VectorNav at 40 Hz behind a node that is late by up to several periods, 95 s with five holes of 17 samples (EECE5554):
// it was 45.4 Hz with 640 samples lost.
TEST(SampleClock, AShortRecordOfLateStampsIsOfItsOwnRate) {
  constexpr double kPeriod_s = 0.025;
  std::mt19937_64 engine(17);
  std::exponential_distribution<double> late_s(1.0 / (0.4 * kPeriod_s));
  const std::vector<std::pair<int, int>> holes{{200, 4}, {1490, 3}, {2150, 3}, {2710, 5}, {2800, 2}};
  std::vector<double> time;
  int number = 0;
  for (int n = 0; n < 3788; ++n, ++number) {
    for (const auto& [after, lost] : holes)
      if (n == after) number += lost;
    const double stamp_s = kPeriod_s * number + late_s(engine);
    time.push_back(time.empty() ? stamp_s : std::max(time.back() + 0.14 * kPeriod_s, stamp_s));
  }
  const SampleClock clock = sample_clock(time);
  EXPECT_NEAR(clock.period_s, kPeriod_s, 1e-4 * kPeriod_s);
  EXPECT_NEAR(static_cast<double>(clock.missing), 17.0, 6.0);
}

// A VMU931: 1 kHz in whole milliseconds, single, in pairs (spread by the reader) and left out; and a silence of 4.4 s.
TEST(SampleClock, WholeMillisecondsOfAKilohertzAreNoGaps) {
  std::vector<double> time = late_stamps(1.0 / 1001.0, 1.7e-3, 0.0);
  for (double& stamp : time) stamp = 1e-3 * std::floor(1e3 * stamp) + (stamp > 0.5 ? 4.4 : 0.0);
  for (std::size_t i = 1; i + 1 < time.size(); ++i)
    if (time[i] <= time[i - 1]) time[i] = 0.5 * (time[i - 1] + std::max(time[i + 1], time[i] + 1e-3));
  const SampleClock clock = sample_clock(time);
  EXPECT_LE(clock.gaps, 2U);  // one may be late stamps at the very end, which cannot return any more
  EXPECT_NEAR(clock.period_s, 1.0 / 1001.0, 1e-7);
}

// Runs of samples at 100 Hz whose stamps are off by up to 3 ms, each begun so long after the one before.
SampleClock clock_of_runs(unsigned seed, int runs, int samples, double apart_s) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> off(-3e-3, 3e-3);
  std::vector<double> time;
  for (int run = 0; run < runs; ++run)
    for (int n = 0; n < samples; ++n) time.push_back(run * apart_s + n * 0.01 + off(engine));
  return sample_clock(time);
}

// A device that restarts after a silence has another phase; so has each burst of twenty samples.
TEST(SampleClock, BehindASilenceThePhaseIsAnother) {
  const SampleClock clock = clock_of_runs(5, 10, 2000, 31.4037), bursts = clock_of_runs(7, 500, 20, 1.0037);
  EXPECT_EQ(clock.gaps, 9U);
  EXPECT_NEAR(clock.period_s, 0.01, 1e-6);
  EXPECT_TRUE(bursts.scatters());
  EXPECT_EQ(bursts.gaps, 499U);
  EXPECT_NEAR(bursts.period_s, 0.01, 1e-5);
}

}  // namespace
}  // namespace ifog
