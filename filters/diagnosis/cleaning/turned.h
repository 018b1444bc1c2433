// SPDX-License-Identifier: Apache-2.0
// Records of a sensor that was turned: without a reference its rotation is no error, and no effect, heading
// forecast or noise figure may be made of it.
#pragma once

#include <list>
#include <string>
#include <vector>

#include "filters/diagnosis/record.h"
#include "filters/series/samples.h"

namespace ifog {

struct WithoutTurns {
  // Turned parts missing, and what is at rest known; as given where a reference stands beside. What is only
  // shaken stays: its means are right.
  std::vector<Record> records;
  std::list<Samples> rates;  // that the records point to
  std::vector<std::string> remarks;
};

// Throws std::invalid_argument with one line when a record was turned and less than half of it is at rest.
WithoutTurns without_turns(const std::vector<Record>& records);

}  // namespace ifog
