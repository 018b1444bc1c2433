// SPDX-License-Identifier: Apache-2.0
// A CSV file in pieces: one thread reads and unpacks it, others turn its text into numbers, and the rows come
// out in order. A capture longer than any memory passes through some tens of MB.
#pragma once

#include <cstddef>
#include <string>

#include "drivers/capture/columns/csv_layout.h"
#include "drivers/capture/files/input_file.h"
#include "drivers/capture/files/text_pieces.h"
#include "drivers/capture/times/row_sink.h"

namespace ifog {

// What the number in a message about a row is: its line, or of a format that has none, counted from 1, the row.
enum class RowsAre { lines, numbered };

// Refuses what read_capture refuses, with the same words, but for what a capture has to have besides a time;
// what is wrong further down may be found when rows were taken. An angle that is to become a rate is the one
// thing that needs all rows at once: then they come as one block. `path` stands for the file in messages.
RowNotes read_csv_rows(const ReadBytes& read, const std::string& path, const CsvLayout& layout, RowSink& sink,
                       std::size_t piece = kTextPiece, RowsAre rows = RowsAre::lines);
// What a file has still to give, which hears how much of it were rows.
RowNotes read_csv_rows(InputFile& file, const CsvLayout& layout, RowSink& sink);

}  // namespace ifog
