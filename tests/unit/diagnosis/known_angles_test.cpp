// SPDX-License-Identifier: Apache-2.0
// What is kept of a running sum is what deviation() and gapped_deviation() give of the series itself.
#include "filters/diagnosis/record/known_angles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "filters/allan/gapped_deviation.h"
#include "filters/allan/stretches.h"

namespace ifog {
namespace {

std::vector<double> walking(unsigned seed) {
  std::mt19937_64 draw(seed);
  std::normal_distribution<double> white;
  std::vector<double> values;
  for (double walk = 0.0; values.size() < 3000; walk += 0.05 * white(draw))
    values.push_back(walk + white(draw));
  return values;
}

void expect_same(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_TRUE(found[i] == expected[i] || (std::isnan(found[i]) && std::isnan(expected[i]))) << i;
}

TEST(KnownAngles, GiveTheDeviationsOfEachSeriesInTurn) {
  const std::vector<std::size_t> few{1, 10, 100}, more{1, 3, 10, 30, 999, 1200};
  std::vector<double> holed = walking(2);
  for (std::size_t i = 100; i < 150; ++i) holed[i] = std::numeric_limits<double>::quiet_NaN();
  KnownAngles known;
  for (const std::vector<double>& series : {walking(1), holed, walking(3), walking(1)})
    for (const auto& m : {few, more, few}) expect_same(known.gapped(series, m), gapped_deviation(series, m));
}

TEST(KnownAngles, OfHolesHaveTheStretchesBetween) {
  std::vector<double> holed = walking(4);
  holed[1000] = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::size_t> m{5, 50};
  KnownAngles known;
  EXPECT_EQ(known.of(holed).parts().size(), 2U);
  const AngleSum sum(std::span<const double>(holed), stretches({}, std::span<const double>(holed), {}));
  const std::vector<DeviationPoint> expected = deviation(sum, m);
  for (int again = 0; again < 2; ++again) {
    const std::vector<DeviationPoint> found = known.points(holed, m);
    for (std::size_t i = 0; i < m.size(); ++i) {
      EXPECT_EQ(found[i].m, m[i]);
      EXPECT_EQ(found[i].terms, expected[i].terms);
      EXPECT_EQ(found[i].variance, expected[i].variance);
    }
  }
}

}  // namespace
}  // namespace ifog
