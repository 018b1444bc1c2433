// SPDX-License-Identifier: Apache-2.0
// The columns of an HDF5 file, read in this process: datasets of a group, each one column, or "name[0]",
// "name[1]", … where it is a matrix of a few columns (N × 3, or 3 × N as MATLAB stores it; 1 × N is one
// column); or the members of a one-dimensional dataset of records (a table of PyTables or pandas). The
// library trusts what it reads, so this runs behind the barrier of hdf5_input.h and nowhere else.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/capture/hdf5/hdf5_id.h"
#include "drivers/system/input_limits.h"

namespace ifog {

// A file by its name, or where it lies in memory.
struct Hdf5Source {
  std::string name;
  std::span<const char> image;  // empty: the file of that name
};

struct Hdf5Wanted {
  std::string group;               // path of the group or table; "": the file's root
  std::vector<std::string> names;  // datasets as paths from there, or members; empty: every dataset of it
  std::string time;                // which of them is the time
  std::uint64_t file_bytes = 0;
};

struct Hdf5Header {
  std::vector<std::string> names;  // of the columns, in the file's order where it keeps one, else sorted
  std::vector<std::string> units;  // of each, as its attribute `units` says, or ""
  std::vector<std::string> comments;
  std::vector<std::string> notices;
  std::uint64_t rows = 0;
  // For a time in integers, which a double may not hold: the first of them, that all of its values are counted
  // from.
  std::optional<std::int64_t> time_from;
  bool exact_time = false;  // the time is time_ns, which replaces time_s
};

inline constexpr std::size_t kLongestHdf5Name = 1000;      // bytes
inline constexpr std::size_t kMostHdf5Comments = 100'000;  // lines
inline constexpr std::size_t kLongestHdf5Text = 4096;      // bytes of a comment

class Hdf5Columns {
 public:
  // Throws std::runtime_error with one line, without the file's name: what is not as a capture needs it.
  Hdf5Columns(const Hdf5Source& source, const Hdf5Wanted& wanted);

  [[nodiscard]] const Hdf5Header& header() const { return header_; }
  // Looks at the first time, which unpacks a chunk; the header says then what the times are counted from.
  // Before anything is read. Throws likewise.
  void count_times_from_first();
  // Rows to read at once: whole chunks of the file, within reason.
  [[nodiscard]] std::size_t block_rows() const { return block_rows_; }
  // Bytes of the largest chunk, unpacked.
  [[nodiscard]] std::size_t chunk_bytes() const { return chunk_bytes_; }
  // Rows from `first` on of a column, as double; a time in integers from its first on. Throws likewise.
  void read(std::size_t column, std::uint64_t first, std::span<double> to);

 private:
  // Which part of a dataset a column is.
  struct Part {
    int rank = 1, along = 0;  // along: the dimension of the rows
    hsize_t index = 0;        // in the other one
  };
  struct Column {
    Hdf5Id dataset, in_memory;  // what one value becomes
    Part part{};
  };
  void read_as_they_are(std::size_t column, std::uint64_t first, std::size_t count, void* to);
  void open(const Hdf5Source& source);
  void read_group(const Hdf5Wanted& wanted);
  void read_members(const Hdf5Wanted& wanted);
  std::vector<std::string> datasets_of_group();
  bool has_exact_time();
  void add_dataset(const std::string& name, bool one);
  void add_what_is_a_column(const std::vector<std::string>& names);
  // The parts of a dataset that are columns: one, or those of a matrix.
  std::vector<Part> check(hid_t dataset, const std::string& name);
  std::vector<Part> take_rows(hid_t dataset, const std::string& name);
  void take_chunk(hid_t dataset, hid_t properties, const Part& part, const std::string& name);
  void check_size(const Hdf5Wanted& wanted) const;
  void keep_unpacked(std::size_t bytes);

  Hdf5Id access_, file_, place_;
  Hdf5Header header_;
  std::vector<Column> columns_;
  std::vector<std::string> groups_;  // within the group
  std::size_t block_rows_ = 0, chunk_bytes_ = 0;
  std::size_t chunk_of_last_ = 0;           // bytes, unpacked, of the dataset checked last
  std::size_t kept_ = 0, kept_of_all_ = 0;  // bytes of unpacked chunks, of a dataset at least and of all
  std::uint64_t stored_ = 0;                // bytes of all values as the file has them, unpacked
  std::string time_;                        // the column's name
  std::optional<std::size_t> whole_time_;   // which that is, where it holds integers
  std::vector<std::int64_t> whole_;         // of it, on their way
};

}  // namespace ifog
