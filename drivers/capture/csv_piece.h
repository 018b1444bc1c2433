// SPDX-License-Identifier: Apache-2.0
// Rows of a CSV file's text as numbers, a piece of it at a time: pieces know nothing of one another, so that
// several are read at once.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/capture/csv_header.h"
#include "drivers/capture/row_checks.h"
#include "drivers/capture/row_sink.h"
#include "drivers/capture/time_stamps.h"

namespace ifog {

struct CsvPiece {
  RowBlock rows;                             // times since the stamps' origin and values in the file's units
  std::string comments;                      // as in RowNotes
  std::vector<RowNotes::Skipped> skipped;    // likewise, from the piece's first row on
  std::vector<ImpossibleValues> impossible;  // by cell of a row; rows of the piece
  std::size_t lines = 0;
  std::size_t row_bytes = 0;  // of the lines that are rows
  bool decimals = false;      // in the first time
  int most_decimals = 0;      // of a time, or kAnyDecimals
};

// The first time of the text, as its cell says it; nothing where it has no row.
std::optional<std::string_view> first_time(std::string_view text, const CsvHeader& header, char separator);

// text: whole lines. stamps: of the whole file's times, which are in unit_s. lines_before: of the file;
// time_before: of the row before, since the same origin, NaN where it is not known. used: rows that are done
// with, whose memory is used again. Throws std::runtime_error with one line: file, line, column, value, what
// was expected.
CsvPiece parse_csv_piece(std::string_view text, const CsvHeader& header, char separator,
                         const TimeStamps& stamps, double unit_s, const std::string& path,
                         std::size_t lines_before,
                         double time_before = std::numeric_limits<double>::quiet_NaN(), RowBlock used = {});

}  // namespace ifog
