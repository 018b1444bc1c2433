// SPDX-License-Identifier: Apache-2.0
// Compares the raw and the compensated rate with the reference rate of the capture, where it has one.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/ifog/denoise/moments.h"
#include "tools/ifog/denoise/offline_chain.h"

namespace ifog::tools {

class ReferenceTrial {
 public:
  // Looks on at what passes through the sink. table: must outlive it.
  void follow(const LongTable& table, OfflineSink& sink);
  // Warns about each axis whose compensated rate is significantly farther from the reference than its raw one.
  void tell(const std::string& capture) const;

 private:
  struct OfAxis {
    const LongColumn* reference = nullptr;           // null: there is none
    Moments raw, compensated;                        // of the present second: minus the reference
    Moments raw_square, compensated_square, growth;  // of the means over 1 s; growth: of their square
  };
  void add(const LongTable& table, double time_s, const Axes& raw_radps, const Axes& compensated_radps);

  std::size_t row_ = 0;
  double second_ = 0.0;
  std::vector<OfAxis> axes_;
};

}  // namespace ifog::tools
