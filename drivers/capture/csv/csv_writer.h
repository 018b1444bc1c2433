// SPDX-License-Identifier: Apache-2.0
// Writes a capture as CSV, block by block.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "drivers/capture/files/output_file.h"
#include "drivers/capture/times/time_stamps.h"

namespace ifog {

// Shortest text that reads back as the same double.
class CsvWriter {
 public:
  // comments: as in RowNotes. Throws as OutputFile does, all of it.
  CsvWriter(const std::string& path, const std::string& comments, const std::vector<std::string>& names);

  // By column, in the order of the names, all of one length. origin: what the first column, the time, is counted
  // from. Times have as many digits as are needed to read the same double back.
  void rows(std::span<const std::span<const double>> columns, const TimeOrigin& origin = {});
  // Without it a regular file stays as it was.
  void finish() { file_.finish(); }

 private:
  OutputFile file_;
  std::string text_;
};

}  // namespace ifog
