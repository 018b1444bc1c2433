// SPDX-License-Identifier: Apache-2.0
// Reads a CSV file in pieces: one thread reads and unpacks, others parse, and rows reach the sink in order.
// Needs some tens of MB for any length.
#pragma once

#include <cstddef>
#include <string>

#include "drivers/capture/columns/csv_layout.h"
#include "drivers/capture/files/input_file.h"
#include "drivers/capture/times/row_sink.h"

namespace ifog {

// Meaning of numbers in messages: lines, or rows counted from 1.
enum class RowsAre { lines, numbered };

// Throws std::runtime_error with one line: file, line, column, value, what was expected, or the options that read the
// file. Errors: time not increasing, a cell that is no number, a line with another number of cells, more than 1 %
// impossible values in a column. Fewer become missing (Measurable) and are listed in `faults`. The sink may have
// received rows before an error is found; angles that become rates arrive as one block.
RowNotes read_csv_rows(const ReadBytes& read, const std::string& path, const CsvLayout& layout, RowSink& sink,
                       std::size_t piece = kTextPiece, RowsAre rows = RowsAre::lines);
// The same for the rest of a file.
RowNotes read_csv_rows(InputFile& file, const CsvLayout& layout, RowSink& sink);

}  // namespace ifog
