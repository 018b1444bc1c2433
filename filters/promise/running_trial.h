// SPDX-License-Identifier: Apache-2.0
// Tests a correction in one pass over a record of any length, by means over some thousand stretches. They
// show slow effects, which a model corrects.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace ifog {

// As in promise.h.
struct ShareThere {
  double share = 0.0, share_error = 0.0;
  bool denied = false;  // PromiseVerdict::broken
};

class RunningTrial {
 public:
  explicit RunningTrial(std::size_t axes) : means_(axes) {}

  // Adds one sample: rates by axis as measured and as corrected, rad/s; NaN if missing. Times before the
  // first one are dropped.
  void add(double time_s, std::span<const double> before_radps, std::span<const double> after_radps);
  // nullopt if the correction does not vary, or the sensor turned or was at rest for fewer than 100
  // stretches: rotation correlated with the correction would be mistaken for an error.
  [[nodiscard]] std::optional<ShareThere> weigh(std::size_t axis) const;

 private:
  struct Sums {
    double before = 0.0, after = 0.0, count = 0.0;
  };
  void widen();

  double stretch_s_ = 1.0;  // averaging time; doubled if there are too many
  double first_s_ = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::vector<Sums>> means_;  // by axis
};

}  // namespace ifog
