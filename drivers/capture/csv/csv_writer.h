// SPDX-License-Identifier: Apache-2.0
// Writes a capture as CSV in blocks.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/csv/text_cells.h"
#include "drivers/capture/files/output_file.h"
#include "drivers/capture/times/time_stamps.h"

namespace ifog {

// Uses the shortest text that reads back as the same double.
class CsvWriter {
 public:
  // comments: as in RowNotes. All functions throw as OutputFile does.
  CsvWriter(const std::string& path, const std::string& comments, const std::vector<std::string>& names)
      : file_(path) {
    for (const std::string& comment : lines_of(comments)) text_ += "# " + comment + "\n";
    for (std::size_t c = 0; c < names.size(); ++c) text_ += (c == 0 ? "" : ",") + as_cell(names[c]);
    text_ += '\n';
    file_.write(text_);
  }

  // Writes rows. columns: in the order of the names, equally long. origin: of the first column, the time.
  // Times have enough digits to read back the same double.
  void rows(std::span<const std::span<const double>> columns, const TimeOrigin& origin = {}) {
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
  // Without it a regular file is not changed.
  void finish() { file_.finish(); }

 private:
  OutputFile file_;
  std::string text_;
};

}  // namespace ifog
