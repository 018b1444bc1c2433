// SPDX-License-Identifier: Apache-2.0
// Columns of an HDF5 file, read in this process. A dataset of a group is a column, or a matrix of a few
// columns "name[0]", "name[1]", … (N × 3, or 3 × N as in MATLAB; 1 × N is one column). Members of a
// one-dimensional dataset of records (PyTables, pandas) are columns too. The library trusts its input, so
// this runs only in the process of hdf5_text.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "drivers/capture/hdf5/hdf5_id.h"

namespace ifog {

struct Hdf5Wanted {
  std::string path;                // of the file
  std::span<const char> image{};   // its content, if it has no name; else empty
  std::string group;               // path of the group or table; "": root
  std::vector<std::string> names;  // dataset paths or members; "sec+nsec": two of them
  bool others = true;              // other columns are read, too
  std::uint64_t file_bytes = 0;
};

// Representation of a value in 8 bytes; integers keep all digits.
enum class Hdf5Value { real, whole, ns };  // ns: integer, written in seconds

struct Hdf5Column {
  std::string name, unit;  // unit: attribute `units`, or ""
  Hdf5Value value = Hdf5Value::real;
  std::uint64_t rows = 0;
  std::size_t value_bytes = 0;  // per value in the file
  Hdf5Id dataset, in_memory;    // in_memory: type of a value after conversion
  int along = 0;                // dimension of the rows
  hsize_t index = 0;            // index in the other dimension
};

class Hdf5Columns {
 public:
  // Throws std::runtime_error with one line, without the file's name, if the file is not suitable.
  explicit Hdf5Columns(const Hdf5Wanted& wanted);

  // The requested columns, then the others in the file's order or sorted.
  [[nodiscard]] const std::vector<Hdf5Column>& columns() const { return columns_; }
  [[nodiscard]] std::uint64_t rows() const { return columns_.front().rows; }
  [[nodiscard]] const std::vector<std::string>& comments() const { return comments_; }
  [[nodiscard]] const std::vector<std::string>& notices() const { return notices_; }
  // Rows per read: whole chunks, so that each is unpacked once.
  [[nodiscard]] std::size_t block_rows() const;
  // Size of the largest chunk, unpacked.
  [[nodiscard]] std::size_t chunk_bytes() const { return chunk_bytes_; }
  // Reads rows of a column from `first` on as double or int64. Throws likewise.
  void read(const Hdf5Column& column, std::uint64_t first, std::span<std::uint64_t> to) const;

 private:
  void open(const Hdf5Wanted& wanted, const std::string& group);
  void choose(const Hdf5Wanted& wanted);
  [[nodiscard]] std::vector<std::string> names_here();
  [[nodiscard]] bool is_table(const char* name) const;
  [[nodiscard]] bool has(const std::string& name) const;
  [[nodiscard]] bool has_exact_time() const;
  // Columns of a member of the group or table. Throws std::runtime_error with one line if it is none.
  [[nodiscard]] std::vector<Hdf5Column> columns_of(const std::string& name);
  [[nodiscard]] std::vector<Hdf5Column> member_of_table(const std::string& name);
  [[nodiscard]] Hdf5Column column_asked_for(const std::string& name);
  void add(Hdf5Column column);
  void check_size(const Hdf5Wanted& wanted) const;

  Hdf5Id access_, file_, place_, record_;  // record_: type of a table's rows
  std::vector<Hdf5Column> columns_;
  std::string here_;                 // path of the group; "": the root
  std::vector<std::string> groups_;  // options that read the groups within it
  std::vector<std::string> comments_, notices_;
  std::size_t chunk_rows_ = 1, chunk_bytes_ = 0;  // of the largest packed chunk
};

}  // namespace ifog
