// SPDX-License-Identifier: Apache-2.0
// Records of a gyro at rest made from the definition of each process, with none of the filter's code.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ifog::bench {

struct MadeRecord {
  std::string state;  // the model that made it, as FilterSettings::state
  std::vector<double> rate;
};

// The kinds in turn, parameters and noise drawn from the seed; a sample a unit of time.
MadeRecord make_record(std::size_t number, std::uint64_t seed, std::size_t samples);

}  // namespace ifog::bench
