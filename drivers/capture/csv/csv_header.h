// SPDX-License-Identifier: Apache-2.0
// Where in a text its table begins, and how it is written: lines of other text above, what stands between the cells,
// the header or none, a row of units; and what each column is to a capture: as the user chose, or as its names say.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/capture/columns/column_roles.h"
#include "drivers/capture/columns/csv_layout.h"
#include "drivers/capture/columns/measurable.h"
#include "drivers/capture/times/row_sink.h"
#include "drivers/capture/times/time_stamps.h"

namespace ifog {

struct TableForm {
  char separator = ',';
  std::size_t header_line = 0;  // its number, from 1; 0 where there is none
  std::size_t last_line = 0;    // the line above the first row: the header, or the row of units below it
  TableSample sample;           // names, units, the first rows, what stands above
};

// text: the file's beginning, whole lines. Throws std::runtime_error with one line: PATH, what was looked
// for. A header that begins with time_s is that of a capture, and the first such line is it; so is the first
// line that has all the names which the layout asks for. Else the header is the line above the first rows of
// as many cells, mostly numbers.
// given: the names of the columns where the lines themselves have them; then there is no header.
TableForm table_form(std::string_view text, const std::vector<std::string>& given, const std::string& path,
                     const CsvLayout& layout);

struct CsvHeader {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  std::vector<std::string> cells;   // of a row: their names in the file
  std::vector<std::string> names;   // of the capture's columns without the time
  std::vector<FileColumn> columns;  // of each, where it is from
  CsvLayout layout;                 // that reads it
  char separator = ',';
  std::string comments;            // that stood before it, as in RowNotes
  std::size_t last_line = 0;       // number of the line above the first row
  std::size_t time_place = kNone;  // which cell is the time; kNone where rows are even
  std::size_t time_part = kNone;   // a second cell of the time: digits behind the point, or a time of day
  std::optional<int> part_digits;  // of it, if there is one; 0: a time of day
  DateOrder date_order = DateOrder::either;
  std::size_t only_place = kNone;    // which cell says whether a row is read
  std::vector<std::string> notices;  // how a foreign header was read, and what rows are in turn
};

// text: whole lines, the file's beginning with at least its first rows. Throws std::runtime_error with one
// line: no time, a name twice, a column that is not there, what is ambiguous, with the options that read it.
// given: names that the lines themselves have, where they do. has_lines: a message says in which.
CsvHeader read_csv_header(std::string_view text, const std::vector<std::string>& given,
                          const std::string& path, const CsvLayout& layout, bool has_lines);

// Rows of a CSV file's text as numbers, one piece of the text at a time. Pieces are independent of one another, so
// that several threads parse them.
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
