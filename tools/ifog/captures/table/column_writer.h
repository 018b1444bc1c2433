// SPDX-License-Identifier: Apache-2.0
// Writes columns to a file in blocks of rows: HDF5 if its name ends so, otherwise CSV. The only place that
// distinguishes the two for writing.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/capture/csv/csv_writer.h"
#include "drivers/capture/hdf5/hdf5_writer.h"
#include "drivers/capture/recording.h"

namespace ifog::tools {

class ColumnWriter {
 public:
  // Throws std::runtime_error with one line.
  ColumnWriter(const std::string& path, const std::string& comments, const std::vector<std::string>& names) {
    is_hdf5(path) ? void(hdf5_.emplace(path, comments, names)) : void(csv_.emplace(path, comments, names));
  }
  // One block, by column in the order of the names, all of one length. origin: of the time in the first
  // column.
  void rows(std::span<const std::span<const double>> columns, const TimeOrigin& origin = {}) {
    hdf5_ ? hdf5_->rows(columns, origin) : csv_->rows(columns, origin);
  }
  // Until then an existing regular file is unchanged.
  void finish() { hdf5_ ? hdf5_->finish() : csv_->finish(); }

 private:
  std::optional<CsvWriter> csv_;
  std::optional<Hdf5Writer> hdf5_;
};

}  // namespace ifog::tools
