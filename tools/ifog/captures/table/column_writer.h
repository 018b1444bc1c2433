// SPDX-License-Identifier: Apache-2.0
// Writes columns to a file: HDF5 if its name ends so, otherwise CSV. The only place that
// distinguishes the two for writing.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/capture/csv/csv_writer.h"
#include "drivers/capture/hdf5/hdf5_writer.h"
#include "drivers/capture/recording.h"
#include "drivers/capture/times/row_sink.h"

namespace ifog::tools {

class ColumnWriter {
 public:
  // Throws std::runtime_error with one line.
  ColumnWriter(const std::string& path, const std::string& comments, const std::vector<std::string>& names) {
    is_hdf5(path) ? void(hdf5_.emplace(path, comments, names)) : void(csv_.emplace(path, comments, names));
  }
  // Appends rows: columns in the order of the names, all of one length. origin: of the time in the first
  // column. done: called with the number of rows after each block.
  void rows(
      std::span<const std::span<const double>> columns, const TimeOrigin& origin,
      const std::function<void(std::size_t)>& done = [](std::size_t) {}) {
    std::vector<std::span<const double>> block(columns.size());
    for (std::size_t begin = 0, end = 0; begin < columns.front().size(); begin = end) {
      end = std::min(begin + RowBatch::kRows, columns.front().size());
      for (std::size_t c = 0; c < block.size(); ++c) block[c] = columns[c].subspan(begin, end - begin);
      hdf5_ ? hdf5_->rows(block, origin) : csv_->rows(block, origin);
      done(end);
    }
  }
  // Until then an existing regular file is unchanged.
  void finish() { hdf5_ ? hdf5_->finish() : csv_->finish(); }

 private:
  std::optional<CsvWriter> csv_;
  std::optional<Hdf5Writer> hdf5_;
};

}  // namespace ifog::tools
