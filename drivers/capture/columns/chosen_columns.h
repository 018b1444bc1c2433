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

}  // namespace ifog
