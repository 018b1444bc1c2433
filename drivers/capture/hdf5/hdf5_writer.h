// SPDX-License-Identifier: Apache-2.0
// A capture into an HDF5 file, written while its rows come: each column a dataset of doubles in the root, in
// chunks, shuffled and packed by gzip, with the attribute `units`; the comments as the attribute `comments`
// of the root. Times that lose digits as doubles stand beside them as integers, time_ns, which reads them as
// they are. The same columns give the same bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "drivers/capture/files/output_file.h"
#include "drivers/capture/hdf5/hdf5_id.h"
#include "drivers/capture/times/time_stamps.h"

namespace ifog {

class Hdf5Writer {
 public:
  // comments: as in RowNotes. Of a path that ends in .gz the whole is packed once more. The packed file is in
  // memory until finish(), so that what cannot be sought does as well. Throws std::runtime_error with one
  // line, all of it.
  Hdf5Writer(const std::string& path, const std::string& comments, const std::vector<std::string>& names);

  // By column, in the order of the names, all of one length. origin: that the first, a time, is counted from,
  // always the same one.
  void rows(std::span<const std::span<const double>> columns, const TimeOrigin& origin = {});
  // Without it a regular file stays as it was.
  void finish();

 private:
  void begin_datasets(std::size_t chunk);
  void take_large_times(std::span<const double> since_s, const TimeOrigin& origin);
  Hdf5Id begin_dataset(const std::string& name, hid_t type, hid_t properties);
  void flush(std::size_t rows);
  template <typename Value>
  void append(const Hdf5Id& dataset, const std::string& name, hid_t type, std::size_t rows,
              std::vector<Value>& held);

  std::string path_;
  std::vector<std::string> names_;
  OutputFile out_;
  Hdf5Id file_;
  std::vector<Hdf5Id> datasets_;           // none before the first rows are written
  std::vector<std::vector<double>> held_;  // by column: rows that fill no chunk
  Hdf5Id exact_;                           // time_ns, where it is
  std::vector<std::int64_t> held_ns_;
  bool times_are_large_ = false;
  hsize_t written_ = 0;  // rows
};

}  // namespace ifog
