// SPDX-License-Identifier: Apache-2.0
#include "filters/series/median_step.h"
#include "tests/unit/test.h"

namespace {

// Against the library's selection of all steps at once.
TEST(MedianStep, IsTheMiddleOfAll) {
  std::mt19937 random(3);
  for (const std::size_t n : {2UL, 3UL, 10UL, 30001UL}) {
    std::vector<double> time{-5.0};
    std::exponential_distribution<double> step(1e3);
    while (time.size() < n) time.push_back(time.back() + step(random));
    std::vector<double> steps;
    for (std::size_t i = 1; i < n; ++i) steps.push_back(time[i] - time[i - 1]);
    std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                     steps.end());
    EXPECT_EQ(ifog::median_step(time), steps[steps.size() / 2]) << n;
  }
}

}  // namespace
