// SPDX-License-Identifier: Apache-2.0
// A capture into an HDF5 file, written while its rows come: each column a dataset of doubles in the root, in
// chunks, shuffled and packed by gzip, with the attribute `units`; the comments as the attribute `comments`
// of the root. The same columns give the same bytes.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "drivers/capture/hdf5/hdf5_id.h"
#include "drivers/capture/text_file.h"

namespace ifog {

class Hdf5Writer {
 public:
  // comments: as in RowNotes. Of a path that ends in .gz the whole is packed once more. The packed file is in
  // memory until finish(), so that what cannot be sought does as well. Throws std::runtime_error with one
  // line, all of it.
  Hdf5Writer(const std::string& path, const std::string& comments, const std::vector<std::string>& names);

  // By column, in the order of the names, all of one length.
  void rows(std::span<const std::span<const double>> columns);
  // Without it a regular file stays as it was.
  void finish();

 private:
  void begin_datasets(std::size_t chunk);
  void flush(std::size_t rows);

  std::string path_;
  std::vector<std::string> names_;
  TextOutput out_;
  Hdf5Id file_;
  std::vector<Hdf5Id> datasets_;           // none before the first rows are written
  std::vector<std::vector<double>> held_;  // by column: rows that fill no chunk
  hsize_t written_ = 0;                    // rows
};

}  // namespace ifog
