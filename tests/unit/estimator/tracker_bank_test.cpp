// SPDX-License-Identifier: Apache-2.0
// The bank of trackers by itself: what all axes do at once is what each would do alone.
#include "filters/estimator/tracker_bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace ifog {
namespace {

// Nominal samples from each measurement to the next: all alike, scattered as by a device's clock, or with
// holes.
std::vector<double> steps(const char* kind, std::size_t count) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform;
  std::vector<double> out;
  for (std::size_t i = 0; i < count; ++i) {
    const double u = uniform(random);
    out.push_back(kind[0] == 'e'   ? 1.0
                  : kind[0] == 's' ? 0.9 + 0.2 * u
                  : u < 0.05       ? 1.0 + std::floor(60.0 * u)
                                   : 1.0);
  }
  return out;
}

// An axis that comes by itself, the others never, goes the way of single numbers; with the others it goes
// with them through vector registers.
TEST(TrackerBank, AnAxisAmongOthersIsTheAxisAlone) {
  for (const char* const kind : {"even", "scattered", "holes"}) {
    TrackerBank together, one(1), among_missing;
    for (TrackerBank* bank : {&together, &one, &among_missing}) bank->reach(300.0);
    ASSERT_GE(together.size(), 6U);
    std::mt19937_64 random(6);
    std::normal_distribution<double> normal;
    for (const double step : steps(kind, 2000)) {
      const Axes rate{normal(random), 3.0 * normal(random), normal(random) - 5.0};
      for (TrackerBank* bank : {&together, &one, &among_missing}) bank->predict(step);
      for (std::size_t j = 0; j < together.size(); ++j) {
        ASSERT_EQ(together.rate(j, 0), one.rate(j, 0)) << kind;
        ASSERT_EQ(together.rate(j, 0), among_missing.rate(j, 0)) << kind;
        ASSERT_EQ(together.factor(j, 0), among_missing.factor(j, 0)) << kind;
        ASSERT_EQ(together.drift_square(j, 0), among_missing.drift_square(j, 0)) << kind;
      }
      together.correct(rate, 7);
      one.correct(rate, 1);
      among_missing.correct(rate, 1);
    }
  }
}

// A tracker has no lag in a rate, slope or curvature that lasts (Morrison 1969): of a parabola without noise
// it foresees each measurement, on each axis its own.
TEST(TrackerBank, AParabolaIsForeseenOnEveryAxis) {
  TrackerBank bank;
  bank.reach(300.0);
  const auto at = [](std::size_t axis, double n) {
    const auto a = static_cast<double>(axis);
    return 1.0 + a + (0.01 - 0.02 * a) * n + 1e-5 * (a - 0.5) * n * n;
  };
  for (int n = 0; n < 600; ++n) {
    bank.predict(1.0);
    Axes rate{};
    for (std::size_t a = 0; a < kMaxAxes; ++a) {
      rate[a] = at(a, n);
      for (std::size_t j = 0; n >= 3 && j < bank.size(); ++j)
        ASSERT_NEAR(bank.rate(j, a), rate[a], 1e-11) << n;
    }
    bank.correct(rate, 7);
  }
}

}  // namespace
}  // namespace ifog
