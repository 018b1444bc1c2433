// SPDX-License-Identifier: Apache-2.0
// A record that is not in memory has the figures of one that is. What those are the other tests say.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "filters/allan/confidence.h"
#include "filters/allan/deviation.h"
#include "filters/allan/noise/noise_coefficients.h"
#include "filters/allan/theo1.h"
#include "filters/rest/rest.h"
#include "filters/series/long_series.h"
#include "tools/simulate/noise.h"

namespace {

using ifog::AngleSum;
using ifog::Deviation;
using ifog::LongSeries;
using ifog::SeriesView;

constexpr double kSampled_hz = 100.0;
constexpr std::size_t kSamples = 300000;

struct Record {
  std::vector<double> time, rate;
  LongSeries long_time{1000}, long_rate{1000};
};

Record record() {
  Record out;
  out.rate = ifog::simulate::noise({.Q = 1e-8, .N = 1e-6, .B = 1e-7, .K = 1e-8}, kSampled_hz, kSamples, 5);
  for (double& rate : out.rate) rate += 7.29e-5;
  std::mt19937 random(2);
  double now = 3.0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    now += i == 100000 || i == 16384 ? 0.5 : 0.01;
    out.time.push_back(now + 1e-5 * static_cast<double>(random() % 100));
  }
  for (const std::size_t missing : {5UL, 16383UL, 40000UL, 250000UL}) out.rate[missing] = std::nan("");
  // Somebody turns it for three seconds.
  for (std::size_t i = 200000; i < 200300; ++i) out.rate[i] += 0.1;
  out.long_time.add(out.time);
  out.long_rate.add(out.rate);
  return out;
}

TEST(LongRecord, HasTheClockTheStretchesAndTheRestOfOneInMemory) {
  const Record r = record();
  const ifog::SampleClock clock = ifog::sample_clock(r.time), same = ifog::sample_clock(r.long_time);
  EXPECT_EQ(clock.gaps, 2U);
  EXPECT_EQ(clock.gaps, same.gaps);
  EXPECT_EQ(clock.period_s, same.period_s);
  EXPECT_EQ(clock.worst_jitter_s, same.worst_jitter_s);
  EXPECT_EQ(clock.missing, same.missing);
  EXPECT_EQ(clock.first_gap, same.first_gap);
  const auto parts = ifog::stretches(r.time, r.rate, clock);
  EXPECT_EQ(parts.size(), 6U);
  EXPECT_EQ(parts, ifog::stretches(r.long_time, r.long_rate, clock));
  const std::vector<SeriesView> in_memory{r.rate}, filed{r.long_rate};
  const ifog::Rest rest = ifog::find_rest(in_memory, {}, clock.period_s);
  EXPECT_GT(rest.turned, 200U);
  EXPECT_EQ(rest.at_rest, ifog::find_rest(filed, {}, clock.period_s).at_rest);
}

TEST(LongRecord, HasTheDeviationsOfOneInMemory) {
  const Record r = record();
  const ifog::SampleClock clock = ifog::sample_clock(r.time);
  const auto parts = ifog::stretches(r.time, r.rate, clock);
  const AngleSum in_memory(r.rate, parts), filed(r.long_rate, parts);
  EXPECT_EQ(filed.mean_radps(), in_memory.mean_radps());
  EXPECT_EQ(filed.samples(), in_memory.samples());
  EXPECT_EQ(filed.longest(), in_memory.longest());
  const auto m = ifog::log_spaced(in_memory.longest() / 4, 10);
  for (const auto kind : {Deviation::kAllan, Deviation::kModified, Deviation::kHadamard}) {
    const auto all = ifog::deviation(in_memory, m, kind);
    // All in one pass; some; each by itself.
    for (const std::size_t at_once : {std::size_t{1} << 24U, std::size_t{5000}, std::size_t{0}}) {
      const auto same = ifog::deviation(filed, m, kind, at_once);
      for (std::size_t k = 0; k < m.size(); ++k) {
        EXPECT_EQ(same[k].terms, all[k].terms);
        EXPECT_NEAR(same[k].variance / all[k].variance, 1.0, 1e-11) << m[k] << " " << at_once;
      }
    }
  }
}

}  // namespace
