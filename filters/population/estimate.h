// SPDX-License-Identifier: Apache-2.0
// Estimate of a parameter from one gyro's captures.
#pragma once

namespace ifog {

struct Estimate {
  double value = 0.0;
  double std_error = 0.0;  // > 0
};

}  // namespace ifog
