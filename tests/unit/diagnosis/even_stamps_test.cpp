// SPDX-License-Identifier: Apache-2.0
// Stamps that scatter about an even clock are set even; steps that are of different lengths stay.
#include "filters/diagnosis/cleaning/steps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "filters/diagnosis/record/even_grid.h"
#include "tests/unit/diagnosis/made_capture.h"

namespace ifog {
namespace {

constexpr std::size_t kSamples = 20000;

Record stamped(const std::vector<double>& time_s, const std::vector<double>& rate) {
  return made_record("sensor", time_s, rate);
}

// 100 Hz with an hour's hole, every stamp off by up to 4 ms either way.
std::vector<double> scattering() {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> off(-4e-3, 4e-3);
  std::vector<double> time_s;
  for (std::size_t i = 0; i < kSamples; ++i)
    time_s.push_back(0.01 * static_cast<double>(i) + (i > 12000 ? 3600.0 : 0.0) + off(engine));
  return time_s;
}

TEST(EvenStamps, NoSampleOfAJitteringLogIsLostOnTheGrid) {
  const std::vector<double> time_s = scattering();
  const std::vector<double> rate(kSamples, 1.0);
  const auto on_grid = [](const Record& record) {
    std::size_t count = 0;
    for (const double value : on_even_grid(record, 0.01, record.rate_radps))
      count += std::isfinite(value) ? 1 : 0;
    return count;
  };
  const std::vector<Record> records{stamped(time_s, rate)};
  EXPECT_LT(on_grid(records[0]), kSamples - kSamples / 20) << "samples share steps by their stamps";
  const OwnedRecords timed = with_even_stamps(records);
  EXPECT_EQ(on_grid(timed.records[0]), kSamples);
  ASSERT_EQ(timed.remarks.size(), 1U);
  EXPECT_NE(timed.remarks[0].find("sensor: the time stamps are up to"), std::string::npos);
  for (std::size_t i = 0; i < kSamples; ++i) EXPECT_NEAR(timed.records[0].time_s[i], time_s[i], 0.025) << i;
}

TEST(EvenStamps, StepsOfDifferentLengthsAndAnEvenClockStay) {
  std::mt19937_64 engine(8);
  std::uniform_real_distribution<double> length(0.007, 0.013);
  std::vector<double> uneven, even;
  double t = 0.0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    uneven.push_back(t += length(engine));
    even.push_back(0.01 * static_cast<double>(i));
  }
  const std::vector<double> rate(kSamples, 1.0);
  for (const std::vector<double>& time_s : {uneven, even}) {
    const OwnedRecords timed = with_even_stamps(std::vector{stamped(time_s, rate)});
    EXPECT_EQ(timed.records[0].time_s.data(), time_s.data());
    EXPECT_TRUE(timed.remarks.empty());
  }
}

}  // namespace
}  // namespace ifog
