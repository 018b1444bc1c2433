// SPDX-License-Identifier: Apache-2.0
// Columns into a file while their rows come: HDF5 where its name ends so, else CSV. The one place that tells
// the two apart for writing.
#pragma once

#include <span>
#include <string>
#include <variant>
#include <vector>

#include "drivers/capture/csv/csv_writer.h"
#include "drivers/capture/hdf5/hdf5_writer.h"
#include "drivers/capture/recording.h"

namespace ifog::tools {

class ColumnWriter {
 public:
  // As both of them. Throws std::runtime_error with one line, all of it.
  ColumnWriter(const std::string& path, const std::string& comments, const std::vector<std::string>& names) {
    if (is_hdf5(path))
      file_.emplace<Hdf5Writer>(path, comments, names);
    else
      file_.emplace<CsvWriter>(path, comments, names);
  }
  // By column, in the order of the names, all of one length. origin: that the first, a time, is counted
  // from.
  void rows(std::span<const std::span<const double>> columns, const TimeOrigin& origin = {}) {
    if (auto* const csv = std::get_if<CsvWriter>(&file_))
      csv->rows(columns, origin);
    else if (auto* const hdf5 = std::get_if<Hdf5Writer>(&file_))
      hdf5->rows(columns, origin);
  }
  // Without it a regular file stays as it was.
  void finish() {
    if (auto* const csv = std::get_if<CsvWriter>(&file_))
      csv->finish();
    else if (auto* const hdf5 = std::get_if<Hdf5Writer>(&file_))
      hdf5->finish();
  }

 private:
  std::variant<std::monostate, CsvWriter, Hdf5Writer> file_;
};

}  // namespace ifog::tools
