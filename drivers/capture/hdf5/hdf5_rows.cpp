// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/hdf5/hdf5_rows.h"

#include <string>
#include <vector>

#include "drivers/capture/csv/csv_rows.h"
#include "drivers/capture/hdf5/hdf5_text.h"

namespace ifog {

RowNotes read_hdf5_rows(InputFile& file, const std::string& group, const CsvLayout& layout, RowSink& sink) {
  Hdf5Wanted wanted{group, {}, true, 0};
  const auto ask = [&](const std::string& header) {
    const bool number = is_number_of_column(header);
    if (!header.empty() && !number) wanted.names.push_back(header);
    wanted.others = wanted.others || number;
  };
  // Where all columns are chosen, nothing else need be unpacked.
  wanted.others = layout.columns.empty() || !layout.time || layout.other_rates;
  if (!layout.columns.empty() && layout.time) ask(layout.time->header);
  for (const CsvColumn& column : layout.columns) ask(column.header);
  ask(layout.only_header);
  Hdf5Text text(file, wanted);
  RowNotes notes = read_csv_rows([&](char* to, std::size_t most) { return text.read(to, most); }, file.path(),
                                 layout, sink, kTextPiece, RowsAre::numbered);
  for (const std::string& notice : text.notices()) notes.notices.push_back(file.path() + ": " + notice);
  return notes;
}

}  // namespace ifog
