// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/gapped_deviation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "filters/allan/deviation.h"
#include "tests/unit/allan/nist_set.h"

namespace ifog {
namespace {

const double kMissing = std::numeric_limits<double>::quiet_NaN();

TEST(GappedDeviation, IsThePublishedOneWithoutAGap) {
  const std::vector<std::size_t> m = {1, 10, 100, 400};
  const std::vector<double> found = gapped_deviation(nist_set(), m);
  EXPECT_NEAR(found[0], 2.922319e-01, 5e-8);
  EXPECT_NEAR(found[1], 9.159953e-02, 5e-8 * 0.3);
  EXPECT_NEAR(found[2], 3.241343e-02, 5e-8 * 0.1);
  EXPECT_TRUE(std::isnan(found[3]));  // no three averages of 400
}

// A sample that is missing at the end says nothing: at one sample the published value, at ten within what one
// more average of nine can change.
TEST(GappedDeviation, IsThePublishedOneBesideAMissingSample) {
  std::vector<double> values = nist_set();
  values.push_back(kMissing);
  const std::vector<std::size_t> m = {1, 10};
  const std::vector<double> found = gapped_deviation(values, m);
  EXPECT_NEAR(found[0], 2.922319e-01, 5e-8);
  EXPECT_NEAR(found[1], 9.159953e-02, 1e-3);
}

// Averages of fewer than half of their samples do not count: by hand, means of two over 1 1 3 3 and a hole.
TEST(GappedDeviation, LeavesOutAveragesThatAreMostlyHole) {
  const std::vector<double> values = {1.0, 1.0, 3.0, 3.0, kMissing, kMissing, kMissing, kMissing, 9.0, 9.0};
  const std::vector<std::size_t> m = {2};
  // Neighbouring means: 1 and 3; 2 and 3, the latter of one sample; none across the hole.
  EXPECT_NEAR(gapped_deviation(values, m)[0], std::sqrt(0.5 * (4.0 + 1.0) / 2.0), 1e-12);
  EXPECT_TRUE(std::isnan(gapped_deviation(std::vector<double>(20, kMissing), m)[0]));
}

}  // namespace
}  // namespace ifog
