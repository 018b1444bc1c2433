// SPDX-License-Identifier: Apache-2.0
// Part of each record that is fitted; the rest is for validation.
#pragma once

#include <cstddef>
#include <vector>

#include "filters/diagnosis/record.h"

namespace ifog {

// Part of a record's time, as fractions.
struct TimeShare {
  double from = 0.0, to = 1.0;
  [[nodiscard]] bool whole() const { return from <= 0.0 && to >= 1.0; }
};

// Samples from … to - 1.
struct SampleRange {
  std::size_t from = 0, to = 0;
  [[nodiscard]] std::size_t size() const { return to - from; }
};

SampleRange samples_in(const Record& record, const TimeShare& share);

// Views of the same arrays.
Record part_of(const Record& record, const SampleRange& samples);
std::vector<Record> fitted_parts(const std::vector<Record>& records, const TimeShare& share);

}  // namespace ifog
