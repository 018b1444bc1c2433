// SPDX-License-Identifier: Apache-2.0
// The range that a value in a capture can have. A number outside of it is no measurement, and a single one would
// dominate a fit. Every command that reads a capture uses these ranges.
#pragma once

#include <cstddef>
#include <limits>
#include <string>

#include "drivers/capture/columns/csv_layout.h"

namespace ifog {

struct Measurable {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool holds(double value) const { return value >= least && value <= most; }
};

// A column of a file, not the time.
struct FileColumn {
  std::string name;       // in the file
  std::size_t place = 0;  // of its cell in a row
  Measurable range;       // in the file's unit
  bool rate = false;      // of the capture: a rate or its reference
  bool kept = true;       // else it is checked only
};

// In the unit of the column's name: rates by what the driver interface allows, channels by what their unit
// can be (no temperature below absolute zero, no field above 100 T), others by the driver interface.
Measurable measurable(const std::string& column);

// The same of a column as its file has it, in the file's unit. An angle may turn for long.
Measurable measurable_in_file(const CsvColumn& column);
Measurable measurable_in_file(const CsvTime& time);

}  // namespace ifog
