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

// What a value is in memory, 8 bytes each: integers keep all their digits.
enum class Hdf5Value { real, whole, natural, ns };  // ns: whole, seconds in the text

struct Hdf5Column {
  std::string name, unit;  // unit: as the attribute `units` says, or ""
  Hdf5Value value = Hdf5Value::real;
  std::uint64_t rows = 0;
  std::size_t value_bytes = 0;  // of one value in the file
  Hdf5Id dataset, in_memory;    // in_memory: the type that one value becomes
  int along = 0;                // the dimension of the rows
  hsize_t index = 0;            // in the other one
};

class Hdf5Columns {
 public:
  // Throws std::runtime_error with one line, without the file's name: what is not as a capture needs it.
  Hdf5Columns(const Hdf5Source& source, const Hdf5Wanted& wanted);

  // Those asked for, then the others in the file's order or else sorted.
  [[nodiscard]] const std::vector<Hdf5Column>& columns() const { return columns_; }
  [[nodiscard]] std::uint64_t rows() const { return columns_.front().rows; }
  [[nodiscard]] const std::vector<std::string>& comments() const { return comments_; }
  [[nodiscard]] const std::vector<std::string>& notices() const { return notices_; }
  // Rows to read at once: whole chunks of the file, so that each is unpacked once.
  [[nodiscard]] std::size_t block_rows() const;
  // Bytes of the largest chunk, unpacked.
  [[nodiscard]] std::size_t chunk_bytes() const { return chunk_bytes_; }
  // Rows from `first` on of a column, as its value is: double, int64 or uint64. Throws likewise.
  void read(const Hdf5Column& column, std::uint64_t first, std::span<std::uint64_t> to) const;

 private:
  void open(const Hdf5Source& source, const std::string& group);
  void choose(const Hdf5Wanted& wanted);
  [[nodiscard]] std::vector<std::string> names_here();
  [[nodiscard]] bool has(const std::string& name) const;
  [[nodiscard]] bool has_exact_time() const;
  // The columns of a member of the group or table. Throws std::runtime_error with one line: it is none.
  [[nodiscard]] std::vector<Hdf5Column> columns_of(const std::string& name);
  [[nodiscard]] std::vector<Hdf5Column> member_of_table(const std::string& name);
  [[nodiscard]] Hdf5Column column_asked_for(const std::string& name);
  void add(Hdf5Column column);
  void check_size(const Hdf5Wanted& wanted) const;

  Hdf5Id access_, file_, place_, record_;  // record_: the type of a table's rows, where the place is one
  std::vector<Hdf5Column> columns_;
  std::vector<std::string> groups_;  // within the group
  std::vector<std::string> comments_, notices_;
  std::size_t chunk_rows_ = 1, chunk_bytes_ = 0;  // of the largest packed chunk
};

}  // namespace ifog
