// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/csv/csv_writer.h"

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/csv/text_cells.h"
#include "drivers/capture/times/row_sink.h"

namespace ifog {

CsvWriter::CsvWriter(const std::string& path, const std::string& comments,
                     const std::vector<std::string>& names)
    : file_(path) {
  for (const std::string& comment : lines_of(comments)) text_ += "# " + comment + "\n";
  for (std::size_t c = 0; c < names.size(); ++c) text_ += (c == 0 ? "" : ",") + as_cell(names[c]);
  text_ += '\n';
  file_.write(text_);
}

void CsvWriter::rows(std::span<const std::span<const double>> columns, const TimeOrigin& origin) {
  text_.clear();
  for (std::size_t row = 0; row < columns.front().size(); ++row) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (c != 0) text_ += ',';
      // Times are written in full: 1763000000 instead of 1.763e+09.
      c == 0 ? append_time(text_, origin, columns[c][row]) : append_shortest(text_, columns[c][row]);
    }
    text_ += '\n';
  }
  file_.write(text_);
}

}  // namespace ifog
