// SPDX-License-Identifier: Apache-2.0
#include "filters/chain/signal_chain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace ifog {
namespace {

// A tenth of a day at 5 kHz, to a tenth of what a day may lose. The terms are whole multiples of 2^-70, so
// that 128-bit integers sum them exactly.
TEST(ExactSum, ATenthOfADayAt5kHzIsExactTo1e10) {
  ExactSum sum;
  __int128 exact = 0;
  std::uint64_t state = 88172645463325252ULL;
  constexpr long kSamples = 24L * 360 * 5000;
  for (long i = 0; i < kSamples; ++i) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    const auto units = static_cast<std::int64_t>(state >> 12);  // 52 bits, exact in a double: 0 … 3.8e-6 rad
    exact += units;
    sum.add(std::ldexp(static_cast<double>(units), -70));
  }
  const auto truth = static_cast<long double>(exact) * 0x1p-70L;
  EXPECT_LT(std::abs(static_cast<long double>(sum.value()) - truth), 1e-10L)
      << "of " << sum.value() << " rad";
}

}  // namespace
}  // namespace ifog
