// SPDX-License-Identifier: Apache-2.0
// What was worked out of a series is taken for the same series, wherever it is, and for no other.
#include "filters/diagnosis/record/known_series.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace ifog {
namespace {

struct Counted {
  KnownOfSeries<double> known{2};
  int worked = 0;
  double first_of(const std::vector<double>& series) {
    return known.of(series, [&](std::span<const double> all) {
      ++worked;
      return all.empty() ? 0.0 : all.front();
    });
  }
};

TEST(KnownOfSeries, TheSameSeriesElsewhereIsNotWorkedOutAgain) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> one{1.0, nan, 3.0, 4.0, 5.0}, copy = one;
  Counted counted;
  EXPECT_EQ(counted.first_of(one), 1.0);
  EXPECT_EQ(counted.first_of(copy), 1.0);
  EXPECT_EQ(counted.worked, 1);
}

// Any bit of any value, an order, a length: each is another series.
TEST(KnownOfSeries, AnyOtherSeriesIsAnother) {
  std::vector<double> series(23);
  for (std::size_t i = 0; i < series.size(); ++i) series[i] = std::sin(static_cast<double>(i));
  const SeriesMark mark = mark_of(series);
  for (std::size_t i = 0; i < series.size(); ++i) {
    std::vector<double> other = series;
    other[i] = std::nextafter(other[i], 2.0);
    EXPECT_FALSE(mark_of(other) == mark) << i;
    other = series;
    other[i] = -other[i];  // the highest bit
    EXPECT_FALSE(mark_of(other) == mark) << i;
    other = series;
    std::swap(other[i], other[(i + 4) % other.size()]);
    EXPECT_FALSE(mark_of(other) == mark) << i;
  }
  EXPECT_FALSE(mark_of(std::span(series).first(22)) == mark);
  series.push_back(0.0);
  EXPECT_FALSE(mark_of(series) == mark);
}

TEST(KnownOfSeries, OfMoreThanItKeepsTheOneAskedForLongestAgoGoes) {
  Counted counted;
  counted.first_of({1.0});
  counted.first_of({2.0});
  counted.first_of({1.0});
  counted.first_of({3.0});  // in the place of 2
  EXPECT_EQ(counted.worked, 3);
  EXPECT_EQ(counted.first_of({1.0}), 1.0);
  EXPECT_EQ(counted.worked, 3);
  EXPECT_EQ(counted.first_of({2.0}), 2.0);
  EXPECT_EQ(counted.worked, 4);
}

// Samples that several share are read through for their mark once, and after a change again.
TEST(KnownOfSeries, OfSharedSamplesTheMarkFollowsEachChange) {
  KnownOfSeries<double> known(8);
  int worked = 0;
  const auto first_of = [&](const SharedSamples& samples) {
    return known.of(samples, [&](std::span<const double> all) {
      ++worked;
      return all.front();
    });
  };
  SharedSamples one(std::vector<double>{1.0, 2.0, 3.0});
  SharedSamples same = one;
  EXPECT_EQ(first_of(one), 1.0);
  EXPECT_EQ(first_of(same), 1.0);
  EXPECT_EQ(first_of(SharedSamples(std::vector<double>{1.0, 2.0, 3.0})), 1.0);  // the same numbers
  EXPECT_EQ(worked, 1);
  same.own()[0] = 4.0;
  EXPECT_EQ(first_of(same), 4.0);
  EXPECT_EQ(first_of(one), 1.0);
  EXPECT_EQ(worked, 2);
  same.own()[0] = 5.0;  // in the same memory
  EXPECT_EQ(first_of(same), 5.0);
  same.anew(2)[0] = 6.0;
  same.own()[1] = 0.0;
  EXPECT_EQ(first_of(same), 6.0);
  EXPECT_EQ(worked, 4);
  EXPECT_EQ(same.mark(), mark_of(std::vector<double>{6.0, 0.0}));
}

}  // namespace
}  // namespace ifog
