// SPDX-License-Identifier: Apache-2.0
// The rates of the sensor's other axes, as a channel of this one.
#pragma once

#include <list>
#include <vector>

#include "filters/diagnosis/record.h"
#include "filters/series/samples.h"

namespace ifog {

struct AlongAxes {
  std::vector<Record> records;  // with the other axes among their channels
  std::list<Samples> values;    // which those show; keep as long as `records`
};

// Where every record has a reference that moves: without one, what two axes have in common is rotation, and a
// correction must not take it away. An axis that has a reference of its own comes as the daemon has it, less
// its own misalignment and scale factor error: what this one is told to see of it is the true rate's. With
// the measured ones three misaligned axes would be left with the square of their angles.
AlongAxes with_other_axes(std::vector<Record> records);

}  // namespace ifog
