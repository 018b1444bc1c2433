// SPDX-License-Identifier: Apache-2.0
// The columns of an HDF5 file, read in this process: datasets of a group, each one column, or "name[0]",
// "name[1]", … where it is a matrix of a few columns (N × 3, or 3 × N as MATLAB stores it; 1 × N is one
// column); or the members of a one-dimensional dataset of records (a table of PyTables or pandas). The
// library trusts what it reads, so this runs in the process of hdf5_text.h and nowhere else.
#pragma once

#include <cstddef>
#include <cstdint>
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
  std::vector<std::string> names;  // datasets as paths from there, or members; "sec+nsec": two of them
  bool others = true;              // what else there is that is a column is read, too
  std::uint64_t file_bytes = 0;
};

struct Hdf5Header {
  std::vector<std::string> names;  // of the columns: those asked for, then in the file's order or else sorted
  std::vector<std::string> units;  // of each, as its attribute `units` says, or ""
  std::vector<std::string> comments;
  std::vector<std::string> notices;
  std::uint64_t rows = 0;
};

// What a value is in memory, 8 bytes each: integers keep all their digits.
enum class Hdf5Value { real, whole, natural, ns };  // ns: whole, seconds in the text

inline constexpr std::size_t kLongestHdf5Name = 1000;      // bytes
inline constexpr std::size_t kMostHdf5Comments = 100'000;  // lines
inline constexpr std::size_t kLongestHdf5Text = 4096;      // bytes of a comment

class Hdf5Columns {
 public:
  // Throws std::runtime_error with one line, without the file's name: what is not as a capture needs it.
  Hdf5Columns(const Hdf5Source& source, const Hdf5Wanted& wanted);

  [[nodiscard]] const Hdf5Header& header() const { return header_; }
  // Rows to read at once: whole chunks of the file, within reason.
  [[nodiscard]] std::size_t block_rows() const { return block_rows_; }
  // Bytes of the largest chunk, unpacked.
  [[nodiscard]] std::size_t chunk_bytes() const { return chunk_bytes_; }
  [[nodiscard]] Hdf5Value value(std::size_t column) const { return columns_[column].value; }
  // Rows from `first` on of a column, as its value is: double, int64 or uint64. Throws likewise.
  void read(std::size_t column, std::uint64_t first, std::span<std::uint64_t> to);

 private:
  // Which part of a dataset a column is.
  struct Part {
    int rank = 1, along = 0;  // along: the dimension of the rows
    hsize_t index = 0;        // in the other one
  };
  struct Column {
    Hdf5Id dataset, in_memory;  // what one value becomes
    Hdf5Value value = Hdf5Value::real;
    Part part{};
  };
  void open(const Hdf5Source& source);
  void read_group(const Hdf5Wanted& wanted);
  void read_members(const Hdf5Wanted& wanted);
  std::vector<std::string> datasets_of_group();
  [[nodiscard]] bool has(const std::string& name) const;
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
};

}  // namespace ifog
