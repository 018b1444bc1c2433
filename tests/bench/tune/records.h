// SPDX-License-Identifier: Apache-2.0
// Records of a gyro at rest, generated from each process's definition without the filter's code.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ifog::bench {

struct MadeRecord {
  std::string state;  // state model that generated it, as FilterSettings::state
  std::vector<double> rate;
};

// Cycles through the kinds; parameters and noise depend on the seed; one sample per unit of time.
MadeRecord make_record(std::size_t number, std::uint64_t seed, std::size_t samples);

}  // namespace ifog::bench
