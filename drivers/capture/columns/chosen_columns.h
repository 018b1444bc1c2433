// SPDX-License-Identifier: Apache-2.0
// Columns that were chosen from a file of other names and units, on their way to those of a capture.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "drivers/capture/columns/csv_layout.h"
#include "drivers/capture/times/row_sink.h"
#include "drivers/units/units.h"

namespace ifog {

// Value in the capture = cell * scale + offset; of an angle in rad.
UnitConversion conversion_of(const CsvColumn& column);

// The columns from the file's units to those of a capture, but for angles, which stay in rad and become rates by
// as_rates().
void convert(RowBlock& rows, const CsvLayout& layout);

// Needs all rows, because only the whole says whether an angle stays within one turn.
// Says in the notes where differences of an angle undo each other, as those of increments do.
void as_rates(RowBlock& all, const CsvLayout& layout, RowNotes& notes, const std::string& path);

// Times that are whole numbers one apart are a count of rows, unless their unit is given; further apart
// and written without decimals they are more often milliseconds than samples of a second each. It is said,
// not changed.
struct WholeTimes {
  std::size_t rows = 0;
  double first_s = 0.0, last_s = 0.0;
  bool whole = true;

  void take(const std::vector<double>& time_s);
  // unit_known: the file says it by more than the column's name.
  [[nodiscard]] std::optional<std::string> notice(const std::string& path, const CsvTime& time,
                                                  bool unit_known) const;
};

}  // namespace ifog
