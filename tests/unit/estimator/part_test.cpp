// SPDX-License-Identifier: Apache-2.0
// A part of a recording that carries the whole's sequence gives the whole's bits, once what came before the
// part is forgotten to the last bit; without the sequence it never does, as other random weights are drawn.
//
// Why not from its first sample on: what a filter remembers of the samples before the part is not in the
// part. An exponential memory of m samples forgets a difference to below the 53rd bit in 37 m, and the last
// bit is then lost to rounding within a few m more.
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>

#include "tests/unit/estimator/drive.h"

namespace ifog::test {
namespace {

constexpr double kRatio = 1e-3;  // gain 0.031
constexpr double kForgotten = 45.0;

// Samples of the part up to the last that differs from the whole's, in rate, variance or gain; `samples` if
// they never come together.
int apart(const FilterSettings& settings, int samples, bool carries) {
  constexpr int kBefore = 20'000;
  const Record r = record(77, kBefore + samples, kRatio);
  Fed whole(settings), part(settings);
  if (carries) part.in.sequence = kBefore;
  const auto differ = [](double a, double b) {
    return std::bit_cast<std::uint64_t>(a) != std::bit_cast<std::uint64_t>(b);
  };
  int last = 0;
  for (int i = 0; i < kBefore + samples; ++i) {
    const Axes rate{r.measured[static_cast<std::size_t>(i)]};
    const EstimatorOutput& of_whole = whole.step(rate);
    if (i < kBefore) continue;
    const EstimatorOutput& of_part = part.step(rate);
    if (differ(of_whole.denoised_radps[0], of_part.denoised_radps[0]) ||
        differ(of_whole.variance_rad2ps2[0], of_part.variance_rad2ps2[0]) ||
        differ(of_whole.gain[0], of_part.gain[0]))
      last = i - kBefore + 1;
  }
  return last;
}

TEST(Part, OfThePapersFilterHasTheBitsOfTheWholeAfterFortyTimeConstants) {
  FilterSettings settings = told(kRatio);
  settings.plain = true;
  const int forgotten = static_cast<int>(kForgotten / 0.031);
  const int carrying = apart(settings, 10'000, true);
  EXPECT_GT(carrying, 0);
  EXPECT_LT(carrying, forgotten);
  EXPECT_EQ(apart(settings, 10'000, false), 10'000);
}

}  // namespace
}  // namespace ifog::test
