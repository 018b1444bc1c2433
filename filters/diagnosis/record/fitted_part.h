// SPDX-License-Identifier: Apache-2.0
// Part of each record that is fitted; the rest is for validation.
#pragma once

#include <vector>

#include "filters/allan/stretches.h"
#include "filters/diagnosis/record.h"

namespace ifog {

// Part of a record's time, as fractions.
struct TimeShare {
  double from = 0.0, to = 1.0;
  [[nodiscard]] bool whole() const { return from <= 0.0 && to >= 1.0; }
};

Stretch samples_in(const Record& record, const TimeShare& share);

// Views of the same arrays.
Record part_of(const Record& record, const Stretch& samples);
std::vector<Record> fitted_parts(const std::vector<Record>& records, const TimeShare& share);

}  // namespace ifog
