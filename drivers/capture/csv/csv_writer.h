// SPDX-License-Identifier: Apache-2.0
// A capture's text, written while its rows come.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "drivers/capture/files/text_file.h"
#include "drivers/capture/times/time_stamps.h"

namespace ifog {

// Shortest text that reads back as the same double.
class CsvWriter {
 public:
  // comments: as in RowNotes. Throws as OutputFile does, all of it.
  CsvWriter(const std::string& path, const std::string& comments, const std::vector<std::string>& names);

  // By column, in the order of the names, all of one length. origin: that the first, a time, is counted
  // from; with one it has as many digits as tell it from other doubles since then.
  void rows(std::span<const std::span<const double>> columns, const TimeOrigin& origin = {});
  // Without it a regular file stays as it was.
  void finish() { file_.finish(); }

 private:
  TextOutput file_;
  std::string text_;
};

}  // namespace ifog
