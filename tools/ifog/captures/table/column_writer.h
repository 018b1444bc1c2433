// SPDX-License-Identifier: Apache-2.0
// Writes columns to a file in blocks of rows: HDF5 if its name ends so, otherwise CSV. The only place that
// distinguishes the two for writing.
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
  // Throws std::runtime_error with one line.
  ColumnWriter(const std::string& path, const std::string& comments, const std::vector<std::string>& names) {
    if (is_hdf5(path))
      file_.emplace<Hdf5Writer>(path, comments, names);
    else
      file_.emplace<CsvWriter>(path, comments, names);
  }
  // One block, by column in the order of the names, all of one length. origin: of the time in the first
  // column.
  void rows(std::span<const std::span<const double>> columns, const TimeOrigin& origin = {}) {
    if (auto* const csv = std::get_if<CsvWriter>(&file_))
      csv->rows(columns, origin);
    else if (auto* const hdf5 = std::get_if<Hdf5Writer>(&file_))
      hdf5->rows(columns, origin);
  }
  // Until then an existing regular file is unchanged.
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
