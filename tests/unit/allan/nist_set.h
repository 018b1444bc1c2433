// SPDX-License-Identifier: Apache-2.0
// The test set whose deviations are published.
#pragma once

#include "tests/unit/test.h"

namespace ifog {

// NIST SP 1065, section 12.4: 1000 frequency values by a linear congruence.
inline std::vector<double> nist_set() {
  std::vector<double> y;
  std::uint64_t n = 1234567890;
  for (int i = 0; i < 1000; ++i) {
    y.push_back(static_cast<double>(n) / 2147483647.0);
    n = 16807 * n % 2147483647;
  }
  return y;
}

}  // namespace ifog
