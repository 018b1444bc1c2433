// SPDX-License-Identifier: Apache-2.0
// Peaks of a structure are named, noise is not taken for one.
#include "filters/diagnosis/residual/resonances.h"
#include "tests/unit/diagnosis/gaussian_deviate.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ifog {
namespace {

double gaussian(std::uint32_t counter, std::uint32_t stream) {
  return gaussian_deviate(counter, stream, 3, 9);
}

TEST(Resonances, AStructureShakenByNoiseIsNamedByItsFrequency) {
  // x'' + 2 d w0 x' + w0^2 x driven by noise, 2 % damping, 3.3 Hz at 100 Hz, as an autoregression of order
  // two.
  const double w0 = 2.0 * M_PI * 3.3 / 100.0;
  const double radius = std::exp(-0.02 * w0);
  double last = 0.0;
  double before = 0.0;
  std::vector<double> error;
  for (std::uint32_t i = 0; i < 200000; ++i) {
    const double x = 2.0 * radius * std::cos(w0) * last - radius * radius * before + 0.1 * gaussian(i, 0);
    before = last;
    last = x;
    error.push_back(x + 0.2 * gaussian(i, 1));
  }
  const std::vector<Resonance> found = find_resonances(error, 0.01);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].frequency_hz, 3.3, 0.1);
  EXPECT_NE(resonances_in_words(found).find(" at 3."), std::string::npos);
}

TEST(Resonances, WhiteNoiseAndAWalkHaveNone) {
  std::vector<double> error;
  double walk = 0.0;
  for (std::uint32_t i = 0; i < 100000; ++i) {
    walk += 0.01 * gaussian(i, 2);
    error.push_back(walk + gaussian(i, 3));
  }
  EXPECT_TRUE(find_resonances(error, 0.01).empty());
  EXPECT_EQ(resonances_in_words({}), "");
}

}  // namespace
}  // namespace ifog
