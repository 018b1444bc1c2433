// SPDX-License-Identifier: Apache-2.0
// Writes a capture as CSV in blocks.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "drivers/capture/files/output_file.h"
#include "drivers/capture/times/time_stamps.h"

namespace ifog {

// Uses the shortest text that reads back as the same double.
class CsvWriter {
 public:
  // comments: as in RowNotes. All functions throw as OutputFile does.
  CsvWriter(const std::string& path, const std::string& comments, const std::vector<std::string>& names);

  // Writes rows. columns: in the order of the names, equally long. origin: of the first column, the time.
  // Times have enough digits to read back the same double.
  void rows(std::span<const std::span<const double>> columns, const TimeOrigin& origin = {});
  // Without it a regular file is not changed.
  void finish() { file_.finish(); }

 private:
  OutputFile file_;
  std::string text_;
};

}  // namespace ifog
