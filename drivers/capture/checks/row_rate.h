// SPDX-License-Identifier: Apache-2.0
// Tells if rows come at another rate from some time on. Analyses assume an even clock, and a device that is set to
// another output rate, or a logger, may change it in a recording.
#pragma once

#include <string>
#include <vector>

#include "drivers/capture/times/row_sink.h"

namespace ifog {

class RowRate {
 public:
  void take(const RowBlock& rows);
  // "rows come at 100 Hz until 12.5 s and at 105 Hz from there on: …"; "" for one rate, up to 1 %.
  [[nodiscard]] std::string change_in_words() const;

 private:
  TimeOrigin origin_;
  std::vector<double> times_;                // of the present window
  std::vector<double> begins_s_, period_s_;  // of each window before
};

}  // namespace ifog
