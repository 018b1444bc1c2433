// SPDX-License-Identifier: Apache-2.0
// Records whose time stamps scatter, by the even clock that their samples were taken by: on their stamps they
// would fall on the same step of a grid twice and on the next one not at all.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/record.h"
#include "filters/series/samples.h"

namespace ifog {

struct TimedRecords {
  std::vector<Record> records;
  std::vector<Samples> times;        // owned, for the records
  std::vector<std::string> remarks;  // a sentence for each record whose stamps were not taken
};

// The dwells of a rate table, and steps that are uneven in themselves, stay as they are stamped.
TimedRecords with_even_stamps(const std::vector<Record>& records);

}  // namespace ifog
