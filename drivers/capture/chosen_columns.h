// SPDX-License-Identifier: Apache-2.0
// Columns that were chosen from a file of other names and units, on their way to those of a capture.
#pragma once

#include <string>

#include "drivers/capture/capture.h"
#include "drivers/capture/csv_layout.h"
#include "drivers/units/units.h"

namespace ifog {

// Value in the capture = cell * scale + offset; of an angle in rad.
UnitConversion conversion_of(const CsvColumn& column);

// From the file's units to those of a capture, angles to rates. Throws std::runtime_error with one line.
void as_chosen(Table& table, const CsvLayout& layout, const std::string& path);

// A file whose times are whole numbers, a second or more apart and written without decimals, is more often
// one in milliseconds than one of a sample a second. It is said, not changed.
void notice_milliseconds(Table& table, const std::string& path);

}  // namespace ifog
