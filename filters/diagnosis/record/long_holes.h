// SPDX-License-Identifier: Apache-2.0
// Captures with a hole that is long beside what was recorded, as records of their own. One grid over such a
// hole would be mostly hole: its blocks too long for what is quick, its samples more than were ever taken,
// its channels a straight line for hours.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/record.h"
#include "filters/diagnosis/record/fitted_part.h"

namespace ifog {

// Where a record was cut from.
struct RecordPart {
  std::size_t of = 0;  // index of the whole
  SampleRange samples;
};

struct PartedRecords {
  std::vector<Record> records;       // of the same arrays; a part's name says when it begins
  std::vector<RecordPart> parts;     // what each of them is of those given
  std::vector<std::string> remarks;  // a sentence for each capture that was parted
};

// A bias may have changed in the hole, so each part has a constant of its own. Parts of a few rows are
// left out, and it is said. Dwells stay together.
PartedRecords part_at_long_holes(const std::vector<Record>& records);
// Each as it is.
PartedRecords not_parted(const std::vector<Record>& records);

}  // namespace ifog
