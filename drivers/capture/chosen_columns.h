// SPDX-License-Identifier: Apache-2.0
// Columns that were chosen from a file of other names and units, on their way to those of a capture.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "drivers/capture/csv_layout.h"
#include "drivers/capture/row_sink.h"
#include "drivers/capture/time_stamps.h"
#include "drivers/units/units.h"

namespace ifog {

// Value in the capture = cell * scale + offset; of an angle in rad.
UnitConversion conversion_of(const CsvColumn& column);

// From the file's units to those of a capture, but for angles, which stay in rad and become rates by
// as_rates(). first_row: of the block in the file; time_before: of the row before it, converted, where there
// is one. Throws std::runtime_error with one line.
// steps: between the times of the block.
void convert(RowBlock& rows, const CsvLayout& layout, const ExactSteps& steps, const RowNotes& notes,
             const std::string& path, std::size_t first_row, double time_before);

// Of all rows, because whether an angle stays within one turn only the whole says.
void as_rates(RowBlock& all, const CsvLayout& layout, const ExactSteps& steps, const RowNotes& notes,
              const std::string& path);

// A file whose times are whole numbers, a second or more apart and written without decimals, is more often
// one in milliseconds than one of a sample a second. It is said, not changed.
struct WholeTimes {
  std::size_t rows = 0;
  double first_s = 0.0, last_s = 0.0;
  bool whole = true;

  void take(const std::vector<double>& time_s);
  [[nodiscard]] std::optional<std::string> notice(const std::string& path) const;
};

}  // namespace ifog
