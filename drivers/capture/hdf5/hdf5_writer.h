// SPDX-License-Identifier: Apache-2.0
// Writes a capture to HDF5 while rows arrive: each column is a dataset of doubles in the root, chunked,
// shuffled and packed by gzip, with the attribute `units`; comments are the root's attribute `comments`.
// Times that lose digits as doubles are also written as integers (time_ns). Equal columns give equal bytes.
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
  // comments: as in RowNotes. With .gz the whole file is packed again. The file is in memory until finish(),
  // so the output need not be seekable. All functions throw std::runtime_error with one line.
  Hdf5Writer(const std::string& path, const std::string& comments, const std::vector<std::string>& names);

  // Appends rows. columns: in the order of the names, equally long. origin: of the first column, a time;
  // always the same.
  void rows(std::span<const std::span<const double>> columns, const TimeOrigin& origin = {});
  // Without it a regular file is not changed.
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
  std::vector<Hdf5Id> datasets_;           // empty before the first rows are written
  std::vector<std::vector<double>> held_;  // by column: rows that do not fill a chunk
  Hdf5Id exact_;                           // time_ns, if needed
  std::vector<std::int64_t> held_ns_;
  bool times_are_large_ = false;
  hsize_t written_ = 0;  // number of rows
};

}  // namespace ifog
