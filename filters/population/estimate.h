// SPDX-License-Identifier: Apache-2.0
// One gyro's value of a parameter, as its captures tell it.
#pragma once

namespace ifog {

struct Estimate {
  double value = 0.0;
  double std_error = 0.0;  // above zero
};

}  // namespace ifog
