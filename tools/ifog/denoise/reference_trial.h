// SPDX-License-Identifier: Apache-2.0
// Compares the raw and the compensated rate with the reference rate of the capture, where it has one.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "filters/settings/axes.h"
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
    std::string name;
    std::span<const double> reference;                 // empty: none
    double raw = 0.0, compensated = 0.0, count = 0.0;  // sums of the present second
    Moments raw_square, compensated_square, growth;    // of means over 1 s; growth: of their square
  };
  void begin(const LongTable& table, const std::vector<std::string>& axes);
  void add(double time_s, const Axes& raw_radps, const Axes& compensated_radps);
  void close_second();

  std::span<const double> time_s_;
  std::size_t row_ = 0;
  double second_ = 0.0;
  std::vector<OfAxis> axes_;
};

}  // namespace ifog::tools
