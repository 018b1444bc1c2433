// SPDX-License-Identifier: Apache-2.0
// An HDF5 file as columns. The library that reads it was made for files that it can trust: a damaged one can
// end the program, and a made one can do worse. So it runs in a process of its own, with bounded memory and
// processor time, without the right to load code or to open other files by links, and what it says is held to
// limits on its way here. When it dies the file is refused with one line.
#pragma once

#include <sys/types.h>

#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "drivers/capture/hdf5/column_stream.h"
#include "drivers/capture/input_file.h"

namespace ifog {

// A file as it can be read more than once: by its name, or kept in memory where that does not open it again.
struct Hdf5File {
  explicit Hdf5File(InputFile& file);

  std::string path, image;
  std::uint64_t bytes = 0;
};

class Hdf5Input {
 public:
  // group: path of the group, or of a table of records; "": the file's root. names: the datasets that are
  // wanted, as paths from there; empty: all of the group. time: which of them it is. Throws
  // std::runtime_error with one line.
  Hdf5Input(const Hdf5File& file, const std::string& group, const std::vector<std::string>& names,
            const std::string& time);
  ~Hdf5Input();
  Hdf5Input(const Hdf5Input&) = delete;
  Hdf5Input& operator=(const Hdf5Input&) = delete;

  [[nodiscard]] const Hdf5Header& header() const { return stream_->header(); }
  // The next rows of every column, in the header's order; false when all have come. Throws likewise.
  bool next(std::vector<std::vector<double>>& block);

 private:
  void start(const Hdf5Source& source, const Hdf5Wanted& wanted);
  [[noreturn]] void refuse(const std::exception& why);
  void end();

  std::string path_;
  int pipe_ = -1;
  pid_t reader_ = -1;
  std::unique_ptr<ColumnStream> stream_;
};

}  // namespace ifog
