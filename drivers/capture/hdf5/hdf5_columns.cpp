// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/hdf5/hdf5_columns.h"

#include <algorithm>
#include <array>
#include <map>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/columns/csv_layout.h"
#include "drivers/ifog/quoted.h"
#include "drivers/system/input_limits.h"
#include "drivers/system/shell_word.h"

namespace ifog {
namespace {

constexpr std::size_t kBlockValues = 2U << 20U;  // of all columns, unless chunks are larger
// Limit of the bytes of all columns' chunks, unpacked. The library needs three times a chunk to unpack one,
// within the process's limit.
constexpr std::size_t kMostUnpacked = 512U << 20U;
// Cache of a matrix or table until all its columns are read, in bytes.
constexpr std::size_t kLeastKept = 512U << 10U, kMostKept = 8U << 20U;
constexpr hsize_t kMostOfMatrix = 64;  // in columns
// Largest compression ratio of a chunk: that of one repeated value is 1000, above deflate's.
constexpr std::uint64_t kMostGrowth = 1100, kGrowthFree = 256U << 20U;
constexpr std::size_t kLongestName = 1000;      // in bytes
constexpr std::size_t kMostComments = 100'000;  // in lines
constexpr std::size_t kLongestText = 4096;      // bytes per comment

[[noreturn]] void refuse(const std::string& what) { throw std::runtime_error(what); }

// "'a', 'b'", limited in length; or "none".
std::string list_of(const std::vector<std::string>& names) {
  return names.empty() ? "none" : printable(listed(names), 300);
}

void demand_numbers(hid_t type, const std::string& name) {
  const H5T_class_t kind = H5Tget_class(type);
  if (kind == H5T_INTEGER || kind == H5T_FLOAT) return;
  refuse(in_quotes(name) + " holds " +
         (kind == H5T_STRING     ? "text"
          : kind == H5T_COMPOUND ? "records of several members"
          : kind == H5T_ENUM     ? "an enumeration"
                                 : "no numbers") +
         ", expected numbers");
}

// Values must be in this file, and their compression must be supported.
void demand_readable(hid_t properties, const std::string& name) {
  if (H5Pget_layout(properties) == H5D_VIRTUAL || H5Pget_external_count(properties) > 0)
    refuse(in_quotes(name) + " keeps its values in another file, expected all in one");
  const int filters = H5Pget_nfilters(properties);
  for (int i = 0; i < filters; ++i) {
    std::array<char, 64> called{};
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter = H5Pget_filter2(properties, static_cast<unsigned>(i), &flags, &values, nullptr,
                                               called.size(), called.data(), &config);
    if (filter >= 0 && H5Zfilter_avail(filter) > 0) continue;
    called.back() = '\0';
    refuse(in_quotes(name) + " is packed by filter " + std::to_string(filter) +
           (called[0] != '\0' ? " (" + printable(called.data()) + ")" : "") +
           ", which is not here, expected gzip; 'h5repack -f GZIP=6' makes it so where it is known");
  }
}

// Integers are kept, because a double may not hold a time in ns.
Hdf5Value value_of(hid_t type) {
  return H5Tget_class(type) == H5T_INTEGER ? Hdf5Value::whole : Hdf5Value::real;
}

hid_t in_memory(Hdf5Value value) { return value == Hdf5Value::real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64; }

// One-dimensional, or a matrix with more rows than columns, in either orientation.
struct Shape {
  int along = 0;
  hsize_t rows = 0, columns = 1;
};

Shape shape_of(hid_t dataset, const std::string& name) {
  const Hdf5Id space(H5Dget_space(dataset));
  const int rank = H5Sget_simple_extent_ndims(space);
  hdf5_demand(rank >= 0, in_quotes(name) + " cannot be read");
  if (rank != 1 && rank != 2)
    refuse(in_quotes(name) + " has " + std::to_string(rank) +
           " dimensions, expected one, or two of a matrix");
  std::array<hsize_t, 2> size{1, 1};
  hdf5_demand(H5Sget_simple_extent_dims(space, size.data(), nullptr) == rank,
              in_quotes(name) + " cannot be read");
  const bool across = rank == 2 && size[0] < size[1];
  if (std::min(size[0], size[1]) > kMostOfMatrix)
    refuse(in_quotes(name) + " is a matrix of " + std::to_string(size[0]) + " × " + std::to_string(size[1]) +
           ", expected at most " + std::to_string(kMostOfMatrix) + " columns");
  return {across ? 1 : 0, size[across ? 1 : 0], size[across ? 0 : 1]};
}

bool contains(const std::vector<std::string>& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

}  // namespace

Hdf5Columns::Hdf5Columns(const Hdf5Wanted& wanted) {
  hdf5_silence();
  H5PLset_loading_state(0);  // no code is loaded
  if (wanted.group != "/") here_ = wanted.group;
  open(wanted, here_.empty() ? "/" : here_);
  choose(wanted);
  comments_ = hdf5_texts(place_, kHdf5Comments, kMostComments, kLongestText);
  if (comments_.empty() && H5Aexists(place_, kHdf5Comments) > 0)
    notices_.emplace_back("not read: its comments, expected an attribute of texts");
  check_size(wanted);
}

void Hdf5Columns::open(const Hdf5Wanted& wanted, const std::string& group) {
  const Hdf5Id how(H5Pcreate(H5P_FILE_ACCESS));
  access_ = Hdf5Id(H5Pcreate(H5P_DATASET_ACCESS));
  // Works where files cannot be locked. Links must not leave the file.
  const auto stay = [](const char*, const char*, const char*, const char*, unsigned*, hid_t,
                       void*) -> herr_t { return -1; };
  hdf5_demand(how.good() && access_.good() && H5Pset_file_locking(how, false, true) >= 0 &&
                  H5Pset_elink_cb(access_, stay, nullptr) >= 0 &&
                  H5Pset_chunk_cache(access_, H5D_CHUNK_CACHE_NSLOTS_DEFAULT, kMostKept, 1.0) >= 0,
              "the HDF5 library does not start");
  const std::span<const char> image = wanted.image;
  if (!image.empty())
    hdf5_demand(H5Pset_fapl_core(how, 1U << 20U, false) >= 0 &&
                    H5Pset_file_image(how, const_cast<char*>(image.data()), image.size()) >= 0,
                "no memory for it");
  // An image needs a name that no file has.
  file_ = Hdf5Id(H5Fopen(image.empty() ? wanted.path.c_str() : "/dev/null/image", H5F_ACC_RDONLY, how));
  hdf5_demand(file_.good(), "cannot be read as HDF5");
  place_ = Hdf5Id(H5Oopen(file_, group.c_str(), access_));
  if (!place_.good()) {
    here_.clear();
    place_ = Hdf5Id(H5Oopen(file_, "/", access_));
    (void)names_here();
    refuse("no group " + in_quotes(group) + ", expected one of the file's: " + list_of(groups_));
  }
  if (H5Iget_type(place_) == H5I_GROUP) return;
  if (H5Iget_type(place_) != H5I_DATASET)
    refuse(in_quotes(group) + " is a type, expected a group of datasets");
  record_ = Hdf5Id(H5Dget_type(place_));
  if (H5Tget_class(record_) != H5T_COMPOUND)
    refuse(in_quotes(group) + " is a dataset, expected the group that holds it, or a table of records");
  if (shape_of(place_, group).columns != 1)
    refuse(in_quotes(group) + " is a matrix of records, expected one column of them");
}

void Hdf5Columns::choose(const Hdf5Wanted& wanted) {
  std::vector<std::string> asked;
  for (const std::string& name : wanted.names)
    for (const std::string& part :
         parts_of_time(name, [&](const std::string& column) { return has(column); }))
      if (!contains(asked, part)) asked.push_back(part);
  std::vector<std::string> others = wanted.others ? names_here() : std::vector<std::string>();
  std::erase_if(others, [&](const std::string& name) { return contains(asked, name); });
  const std::size_t kept = kMostUnpacked / (asked.size() + others.size() + 1);
  H5Pset_chunk_cache(access_, H5D_CHUNK_CACHE_NSLOTS_DEFAULT, std::clamp(kept, kLeastKept, kMostKept), 1.0);
  for (const std::string& name : asked) add(column_asked_for(name));

  const auto time = std::ranges::find(others, kHdf5Time);
  const bool capture = asked.empty() && time != others.end() && !record_.good();
  if (capture) std::rotate(others.begin(), time, time + 1);  // time first, as in CSV
  if (has_exact_time()) std::erase(others, kHdf5ExactTime);
  // All datasets of a capture are columns. In other groups those with the most frequent number of rows are.
  std::vector<std::vector<Hdf5Column>> found;
  std::map<std::uint64_t, std::size_t> with_rows;
  for (const std::string& name : others) try {
      found.push_back(columns_of(name));
      ++with_rows[found.back().front().rows];
    } catch (const std::runtime_error&) {
      if (capture) throw;
    }
  std::uint64_t rows = columns_.empty() ? 0 : columns_.front().rows;
  if (columns_.empty())
    for (const auto& [count, datasets] : with_rows)
      if (count > 1 && (rows == 0 || datasets >= with_rows[rows])) rows = count;
  for (std::vector<Hdf5Column>& dataset : found)
    for (Hdf5Column& column : dataset)
      if ((capture || column.rows == rows) && !contains(asked, column.name)) add(std::move(column));
  if (!groups_.empty() && !columns_.empty())
    notices_.push_back("not read: the groups and tables of " + list_of(groups_));
}

// Members of records, or all links of the group except groups. Anything that is no dataset is rejected when
// opened.
std::vector<std::string> Hdf5Columns::names_here() {
  std::vector<std::string> names;
  const auto few = [](std::size_t members) {
    if (members > kInputLimits.hdf5_columns)
      refuse("the group has " + std::to_string(members) + " members, expected at most " +
             std::to_string(kInputLimits.hdf5_columns));
  };
  if (record_.good()) {
    const int members = H5Tget_nmembers(record_);
    few(static_cast<std::size_t>(std::max(0, members)));
    for (int i = 0; i < members; ++i) {
      char* const name = H5Tget_member_name(record_, static_cast<unsigned>(i));
      hdf5_demand(name != nullptr, "its records cannot be read");
      names.emplace_back(name);
      H5free_memory(name);
    }
    return names;
  }
  H5G_info_t info{};
  const Hdf5Id made(H5Gget_create_plist(place_));
  unsigned order = 0;
  hdf5_demand(H5Gget_info(place_, &info) >= 0 && made.good() && H5Pget_link_creation_order(made, &order) >= 0,
              "its group cannot be read");
  few(info.nlinks);
  const H5_index_t by = (order & H5P_CRT_ORDER_TRACKED) != 0 ? H5_INDEX_CRT_ORDER : H5_INDEX_NAME;
  groups_.clear();
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    std::array<char, kLongestName + 2> name{};
    const ssize_t length =
        H5Lget_name_by_idx(place_, ".", by, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT);
    hdf5_demand(length > 0, "its group cannot be read");
    if (static_cast<std::size_t>(length) > kLongestName)
      refuse("a name of " + std::to_string(length) + " bytes, expected at most " +
             std::to_string(kLongestName));
    H5O_info_t object{};
    const bool is_group = H5Oget_info_by_name2(place_, name.data(), &object, H5O_INFO_BASIC, access_) >= 0 &&
                          object.type == H5O_TYPE_GROUP;
    if (is_group || is_table(name.data()))
      groups_.push_back("--group " + shell_word(here_ + "/" + name.data()));
    if (!is_group) names.emplace_back(name.data());
  }
  return names;
}

// Records, as of PyTables.
bool Hdf5Columns::is_table(const char* name) const {
  const Hdf5Id object(H5Oopen(place_, name, access_));
  if (!object.good() || H5Iget_type(object) != H5I_DATASET) return false;
  return H5Tget_class(Hdf5Id(H5Dget_type(object))) == H5T_COMPOUND;
}

bool Hdf5Columns::has(const std::string& name) const {
  if (record_.good()) return H5Tget_member_index(record_, name.c_str()) >= 0;
  const auto is_there = [&](const std::string& path) {
    return !path.empty() && Hdf5Id(H5Oopen(place_, path.c_str(), access_)).good();
  };
  return is_there(name) || is_there(without_index(name));
}

// As written by Hdf5Writer.
bool Hdf5Columns::has_exact_time() const {
  if (record_.good() || H5Lexists(place_, kHdf5ExactTime, access_) <= 0) return false;
  const Hdf5Id exact(H5Dopen2(place_, kHdf5ExactTime, access_));
  return exact.good() && hdf5_texts(exact, kHdf5Of, 1, kLongestName) == std::vector<std::string>{kHdf5Time};
}

std::vector<Hdf5Column> Hdf5Columns::columns_of(const std::string& name) {
  if (record_.good()) return member_of_table(name);
  const bool exact = name == kHdf5Time && has_exact_time();
  const std::string path = exact ? kHdf5ExactTime : name;
  const Hdf5Id found(H5Oopen(place_, path.c_str(), access_));
  if (!found.good()) {
    H5L_info_t link{};
    const bool there = H5Lget_info(place_, path.c_str(), &link, access_) >= 0;
    if (there && link.type == H5L_TYPE_EXTERNAL)
      refuse(in_quotes(name) + " is a link into another file, expected all in one");
    if (there) refuse(in_quotes(name) + " leads to nothing: " + hdf5_reason());
    refuse("no dataset " + in_quotes(name) + ", the group has " + list_of(names_here()));
  }
  if (H5Iget_type(found) != H5I_DATASET) refuse(in_quotes(name) + " is no dataset, expected one of numbers");
  const Hdf5Id type(H5Dget_type(found));
  demand_numbers(type, name);
  const Shape shape = shape_of(found, name);
  const Hdf5Value value = exact ? Hdf5Value::ns : value_of(type);
  std::vector<Hdf5Column> columns;
  for (hsize_t i = 0; i < shape.columns; ++i)
    columns.push_back({shape.columns == 1 ? name : name + "[" + std::to_string(i) + "]",
                       exact ? "s" : hdf5_unit(found), value, shape.rows, H5Tget_size(type),
                       Hdf5Id(H5Dopen2(place_, path.c_str(), access_)), Hdf5Id(H5Tcopy(in_memory(value))),
                       shape.along, i});
  return columns;
}

std::vector<Hdf5Column> Hdf5Columns::member_of_table(const std::string& name) {
  const int member = H5Tget_member_index(record_, name.c_str());
  if (member < 0) refuse("no column " + in_quotes(name) + ", the table has " + list_of(names_here()));
  const Hdf5Id type(H5Tget_member_type(record_, static_cast<unsigned>(member)));
  demand_numbers(type, name);
  const Shape shape = shape_of(place_, name);
  const Hdf5Value value = value_of(type);
  Hdf5Id one(H5Tcreate(H5T_COMPOUND, H5Tget_size(in_memory(value))));
  hdf5_demand(one.good() && H5Tinsert(one, name.c_str(), 0, in_memory(value)) >= 0,
              in_quotes(name) + " cannot be read");
  std::vector<Hdf5Column> columns;
  columns.push_back({name, "", value, shape.rows, H5Tget_size(type), Hdf5Id(H5Dopen2(place_, ".", access_)),
                     std::move(one), shape.along, 0});
  return columns;
}

Hdf5Column Hdf5Columns::column_asked_for(const std::string& name) {
  const bool of_matrix =
      !record_.good() && without_index(name) != name && H5Lexists(place_, name.c_str(), access_) <= 0;
  const std::string dataset = of_matrix ? without_index(name) : name;
  std::vector<Hdf5Column> columns = columns_of(dataset);
  if (!of_matrix && columns.size() > 1)
    refuse(in_quotes(name) + " is a matrix, expected one of its columns: " + name + "[0] to " + name + "[" +
           std::to_string(columns.size() - 1) + "]");
  for (Hdf5Column& column : columns)
    if (!of_matrix || name == dataset + "[" + std::to_string(column.index) + "]") {
      column.name = name;
      return std::move(column);
    }
  refuse("no column " + in_quotes(name) + ", " + in_quotes(dataset) + " has " +
         std::to_string(columns.size()));
}

// Packed data are read in whole chunks, so that each is unpacked once.
void Hdf5Columns::add(Hdf5Column column) {
  if (columns_.size() == kInputLimits.hdf5_columns)
    refuse("more than " + std::to_string(kInputLimits.hdf5_columns) + " columns, expected at most that");
  if (!columns_.empty() && column.rows != rows())
    refuse(in_quotes(column.name) + " has " + std::to_string(column.rows) + " rows, expected the " +
           std::to_string(rows()) + " of " + in_quotes(columns_.front().name));
  const Hdf5Id properties(H5Dget_create_plist(column.dataset)), type(H5Dget_type(column.dataset));
  hdf5_demand(properties.good() && type.good(), in_quotes(column.name) + " cannot be read");
  demand_readable(properties, column.name);
  std::array<hsize_t, 2> chunk{1, 1};
  if (H5Pget_nfilters(properties) > 0 && H5Pget_layout(properties) == H5D_CHUNKED &&
      H5Pget_chunk(properties, 2, chunk.data()) > 0) {
    std::uint64_t bytes = 0, all = 0;  // of one chunk; of all columns as numbers
    chunk_rows_ = std::max<std::size_t>(chunk_rows_, chunk[static_cast<std::size_t>(column.along)]);
    if (__builtin_mul_overflow(chunk[0], chunk[1], &bytes) ||
        __builtin_mul_overflow(bytes, H5Tget_size(type), &bytes) || bytes > kMostUnpacked ||
        __builtin_mul_overflow(chunk_rows_, (columns_.size() + 1) * sizeof(double), &all) ||
        all > kMostUnpacked)
      refuse(in_quotes(column.name) + " is packed in chunks of " +
             std::to_string(std::max(bytes, all) >> 20U) + " MiB, expected at most " +
             std::to_string(kMostUnpacked >> 20U) + " MiB in all columns; 'h5repack -l CHUNK=65536' helps");
    chunk_bytes_ = std::max<std::size_t>(chunk_bytes_, bytes);
  }
  columns_.push_back(std::move(column));
}

void Hdf5Columns::check_size(const Hdf5Wanted& wanted) const {
  if (columns_.empty())
    refuse("no dataset of numbers in the group " + in_quotes(here_.empty() ? "/" : here_) +
           (groups_.empty() ? "" : "; its groups and tables are read by " + list_of(groups_)));
  if (rows() == 0) refuse("no rows in its datasets");
  std::uint64_t stored = 0;
  for (const Hdf5Column& column : columns_) stored += column.rows * column.value_bytes;
  const std::uint64_t most = std::max(kGrowthFree, wanted.file_bytes * kMostGrowth);
  if (rows() > most || stored > most)
    refuse("grows to more than " + std::to_string(most >> 20U) + " MiB, " + std::to_string(kMostGrowth) +
           " times its size, when unpacked, expected a recording");
}

std::size_t Hdf5Columns::block_rows() const {
  const std::size_t chunks = kBlockValues / columns_.size() / chunk_rows_;
  return chunk_rows_ * std::max<std::size_t>(1, chunks);
}

void Hdf5Columns::read(const Hdf5Column& column, std::uint64_t first, std::span<std::uint64_t> to) const {
  const auto along = static_cast<std::size_t>(column.along);
  std::array<hsize_t, 2> start{column.index, column.index}, count{1, 1};
  start[along] = first;
  count[along] = to.size();
  const hsize_t all = to.size();
  const Hdf5Id space(H5Dget_space(column.dataset)), memory(H5Screate_simple(1, &all, nullptr));
  hdf5_demand(
      space.good() && memory.good() &&
          H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) >= 0 &&
          H5Dread(column.dataset, column.in_memory, memory, space, H5P_DEFAULT, to.data()) >= 0,
      in_quotes(column.name) + " cannot be read from row " + std::to_string(first + 1) + " on");
}

}  // namespace ifog
