// SPDX-License-Identifier: Apache-2.0
// A correction weighed in one pass over a record of any length, by means of some thousand stretches of it:
// what is slow shows in them, and that is what a model corrects.
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

  // One sample: rates by axis as measured and as corrected, rad/s; NaN: missing. A time before the first is
  // dropped.
  void add(double time_s, std::span<const double> before_radps, std::span<const double> after_radps);
  // Nothing where the correction does not move, the sensor turned, or rested for fewer than 100 of the
  // stretches: a rotation correlated with the correction would be mistaken for it.
  [[nodiscard]] std::optional<ShareThere> weigh(std::size_t axis) const;

 private:
  struct Sums {
    double before = 0.0, after = 0.0, count = 0.0;
  };
  void widen();

  double stretch_s_ = 1.0;  // of a mean; doubled whenever there are too many
  double first_s_ = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::vector<Sums>> means_;  // by axis
};

}  // namespace ifog
