// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/noise/noise_likelihood.h"

#include <gtest/gtest.h>

#include <vector>

#include "tools/simulate/noise.h"

namespace {

using ifog::TermSet;

// What more terms can describe no worse, the search has to find no worse: cutting off steps that left the
// admissible variances ended a hundred units of log-likelihood below the maximum, in four of five records of
// a random walk alone.
TEST(NoiseLikelihood, TheMaximumOverMoreTermsIsNeverLower) {
  constexpr double kSlack = 1e-3;
  for (const ifog::simulate::NoiseLevels& levels :
       {ifog::simulate::NoiseLevels{.N = 1.0}, ifog::simulate::NoiseLevels{.B = 1.0},
        ifog::simulate::NoiseLevels{.K = 1.0}, ifog::simulate::NoiseLevels{.N = 1.0, .K = 0.03}})
    for (std::uint64_t seed = 900; seed < 910; ++seed) {
      const auto rate = ifog::simulate::noise(levels, 1.0, 4096, seed);
      const std::vector<ifog::Stretch> all{{0, rate.size()}};
      const auto spectrum = ifog::noise_spectrum(ifog::AngleSum(rate, all));
      const ifog::NoiseLikelihood likelihood(spectrum, ifog::Ramp::kProjected);
      const double most = likelihood.maximise(TermSet().set()).log_likelihood;
      for (unsigned long bits = 1; bits < 1UL << ifog::kTerms; ++bits) {
        const auto some = likelihood.maximise(TermSet(bits));
        EXPECT_LE(some.log_likelihood, most + kSlack) << TermSet(bits) << " seed " << seed;
        EXPECT_NEAR(likelihood.maximise(TermSet(bits), some.variances).log_likelihood, some.log_likelihood,
                    kSlack)
            << TermSet(bits) << " seed " << seed;
      }
    }
}

}  // namespace
