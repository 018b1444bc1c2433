// SPDX-License-Identifier: Apache-2.0
// Parses rows of a CSV text in independent pieces, so that several threads can parse.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/capture/csv/csv_header.h"
#include "drivers/capture/times/row_sink.h"

namespace ifog {

// A reused piece keeps the memory of its text and rows, because new pages cost as much as reading.
struct CsvPiece {
  std::string text;               // whole lines
  RowBlock rows;                  // times since the stamps' origin; values in the file's units
  std::string comments;           // as in RowNotes
  std::vector<Fault> impossible;  // by column: impossible values, read as missing
  std::size_t lines = 0;
  std::size_t row_bytes = 0;  // of the lines that are rows
  std::size_t untimed = 0;    // rows of another sensor, without a time
  Fault damaged;              // dropped lines that are no rows
  Fault unended;              // an incomplete and damaged last line
  Fault too_long;             // a line that is too long, and its beginning
  std::size_t places = 0;     // rows and damaged lines, which equidistant rows count
};

// Stamps relative to the text's first time; nullopt if it has no row.
std::optional<TimeStamps> stamps_from(std::string_view text, const CsvHeader& header);

// Parses the piece's text and replaces the rest of it. stamps: of the whole file. Equidistant rows have their
// numbers as times. Line numbers start at 1 in each piece. Invalid rows are dropped and counted; parsing stops
// at a line that is too long.
void parse(CsvPiece& piece, const CsvHeader& header, const TimeStamps& stamps);

}  // namespace ifog
