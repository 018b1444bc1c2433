// SPDX-License-Identifier: Apache-2.0
// Rows of a CSV file's text as numbers, one piece of the text at a time. Pieces are independent of one another, so
// that several threads parse them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/capture/csv/csv_header.h"
#include "drivers/capture/times/row_sink.h"

namespace ifog {

struct CsvPiece {
  RowBlock rows;                  // times since the stamps' origin and values in the file's units
  std::string comments;           // as in RowNotes
  std::vector<Fault> impossible;  // by column: values that no sensor measures, read as missing
  std::size_t lines = 0;
  std::size_t row_bytes = 0;  // of the lines that are rows
  std::size_t untimed = 0;    // rows of another sensor, which have no time of this one
  Fault damaged;              // lines that cannot be read as rows, dropped
  Fault unended;              // the last line, where it has no end and is damaged
  Fault too_long;             // a line that no text has, with its beginning
  std::size_t places = 0;     // rows and damaged lines: what even rows count
};

// The stamps that count from the text's first time; nothing where it has no row.
std::optional<TimeStamps> stamps_from(std::string_view text, const CsvHeader& header);

// text: whole lines. stamps: of the whole file's times. Where rows are even, times are the numbers of the rows.
// used: a block whose memory is used again. Lines count from the piece's own first. A row that cannot be read is
// dropped and counted; a line that is too long is the last one looked at.
CsvPiece parse_csv_piece(std::string_view text, const CsvHeader& header, const TimeStamps& stamps,
                         RowBlock used = {});

}  // namespace ifog
