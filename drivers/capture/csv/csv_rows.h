// SPDX-License-Identifier: Apache-2.0
// Reads a CSV file in pieces: one thread reads and unpacks it, others turn its text into numbers, and the rows reach
// the sink in order. A file of any length needs some tens of MB.
#pragma once

#include <cstddef>
#include <string>

#include "drivers/capture/columns/csv_layout.h"
#include "drivers/capture/files/input_file.h"
#include "drivers/capture/times/row_sink.h"

namespace ifog {

// What the number in a message about a row is: its line, or of a format that has none, counted from 1, the row.
enum class RowsAre { lines, numbered };

// Refuses what read_capture refuses, in the same words, but needs no rate. The sink may have received rows before
// an error further down is found; angles that become rates arrive as one block. `path`: the file in messages.
RowNotes read_csv_rows(const ReadBytes& read, const std::string& path, const CsvLayout& layout, RowSink& sink,
                       std::size_t piece = kTextPiece, RowsAre rows = RowsAre::lines);
// The same of what remains of a file.
RowNotes read_csv_rows(InputFile& file, const CsvLayout& layout, RowSink& sink);

}  // namespace ifog
