// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/hdf5/hdf5_columns.h"

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <utility>

#include "drivers/capture/hdf5/hdf5_attributes.h"
#include "drivers/capture/hdf5/hdf5_places.h"

namespace ifog {
namespace {

constexpr std::size_t kLeastBlock = 65'536, kMostBlock = 1'048'576;  // rows
// Bytes of unpacked chunks: of a dataset, and of all together. The library takes three times a chunk while it
// unpacks it, and all of it stands below what its process may have.
constexpr std::size_t kLeastKept = 512U << 10U, kMostKept = 8U << 20U, kKeptOfAll = 512U << 20U;
constexpr hsize_t kMostOfMatrix = 64;  // columns
// What a chunk of one value packs into, a thousandth, and more than deflate can: rows come block by block,
// and what is kept of them is bounded elsewhere.
constexpr std::uint64_t kMostGrowth = 1100, kGrowthFree = 256U << 20U;

[[noreturn]] void refuse(const std::string& what) { throw std::runtime_error(what); }

void demand_numbers(hid_t type, const std::string& name) {
  const H5T_class_t kind = H5Tget_class(type);
  if (kind == H5T_INTEGER || kind == H5T_FLOAT) return;
  refuse(in_quotes(name) + " holds " + kind_of(kind) + ", expected numbers");
}

// The values must lie in this file, and be packed by what is here to unpack them.
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

// Integers stay what they are, as a double may not hold a time in ns.
Hdf5Value value_of(hid_t type) {
  if (H5Tget_class(type) != H5T_INTEGER) return Hdf5Value::real;
  return H5Tget_sign(type) == H5T_SGN_NONE ? Hdf5Value::natural : Hdf5Value::whole;
}

hid_t in_memory(Hdf5Value value) {
  if (value == Hdf5Value::real) return H5T_NATIVE_DOUBLE;
  return value == Hdf5Value::natural ? H5T_NATIVE_UINT64 : H5T_NATIVE_INT64;
}

// What reads one member of a record.
Hdf5Id one_member(const std::string& name, hid_t number) {
  Hdf5Id one(H5Tcreate(H5T_COMPOUND, H5Tget_size(number)));
  hdf5_demand(one.good() && H5Tinsert(one, name.c_str(), 0, number) >= 0,
              in_quotes(name) + " cannot be read");
  return one;
}

}  // namespace

Hdf5Columns::Hdf5Columns(const Hdf5Source& source, const Hdf5Wanted& wanted) {
  hdf5_silence();
  H5PLset_loading_state(0);  // no file has code loaded to read it
  open(source);
  const std::string group = wanted.group.empty() ? "/" : wanted.group;
  place_ = Hdf5Id(H5Oopen(file_, group.c_str(), access_));
  if (!place_.good())
    refuse("no group " + in_quotes(group) + ", the file has the groups " + list_of(places_of(file_)));
  if (H5Iget_type(place_) == H5I_GROUP)
    read_group(wanted);
  else if (H5Iget_type(place_) == H5I_DATASET)
    read_members(wanted);
  else
    refuse(in_quotes(group) + " is a type, expected a group of datasets");
  header_.comments = hdf5_texts(place_, kHdf5Comments, kMostHdf5Comments, kLongestHdf5Text);
  if (header_.comments.empty() && H5Aexists(place_, kHdf5Comments) > 0)
    header_.notices.push_back("not read: its comments, expected an attribute of texts");
  check_size(wanted);
}

void Hdf5Columns::open(const Hdf5Source& source) {
  const Hdf5Id how(H5Pcreate(H5P_FILE_ACCESS));
  access_ = Hdf5Id(H5Pcreate(H5P_DATASET_ACCESS));
  // A capture is read where nothing can be locked, too. No link leads out of the file.
  const auto stay = [](const char*, const char*, const char*, const char*, unsigned*, hid_t,
                       void*) -> herr_t { return -1; };
  hdf5_demand(how.good() && access_.good() && H5Pset_file_locking(how, false, true) >= 0 &&
                  H5Pset_elink_cb(access_, stay, nullptr) >= 0,
              "the HDF5 library does not start");
  keep_unpacked(kMostKept);
  const bool in_memory = !source.image.empty();
  if (in_memory)
    hdf5_demand(H5Pset_fapl_core(how, 1U << 20U, false) >= 0 &&
                    H5Pset_file_image(how, const_cast<char*>(source.image.data()), source.image.size()) >= 0,
                "no memory for it");
  // An image takes a name that no file has.
  file_ = Hdf5Id(H5Fopen(in_memory ? "/dev/null/image" : source.name.c_str(), H5F_ACC_RDONLY, how));
  hdf5_demand(file_.good(), "cannot be read as HDF5");
}

// Applies to each dataset that is opened from here on.
void Hdf5Columns::keep_unpacked(std::size_t bytes) {
  hdf5_demand(H5Pset_chunk_cache(access_, H5D_CHUNK_CACHE_NSLOTS_DEFAULT, bytes, 1.0) >= 0,
              "the HDF5 library does not start");
  kept_ = bytes;
}

// Every link of the group that is no group: what is no dataset is refused where it is opened.
std::vector<std::string> Hdf5Columns::datasets_of_group() {
  H5G_info_t info{};
  const Hdf5Id made(H5Gget_create_plist(place_));
  unsigned order = 0;
  hdf5_demand(H5Gget_info(place_, &info) >= 0 && made.good() && H5Pget_link_creation_order(made, &order) >= 0,
              "its group cannot be read");
  if (info.nlinks > kInputLimits.hdf5_columns)
    refuse("the group has " + std::to_string(info.nlinks) + " members, expected at most " +
           std::to_string(kInputLimits.hdf5_columns));
  const H5_index_t by = (order & H5P_CRT_ORDER_TRACKED) != 0 ? H5_INDEX_CRT_ORDER : H5_INDEX_NAME;
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    std::array<char, kLongestHdf5Name + 2> name{};
    const ssize_t length =
        H5Lget_name_by_idx(place_, ".", by, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT);
    hdf5_demand(length > 0, "its group cannot be read");
    if (static_cast<std::size_t>(length) > kLongestHdf5Name)
      refuse("a name of " + std::to_string(length) + " bytes, expected at most " +
             std::to_string(kLongestHdf5Name));
    H5O_info_t object{};
    const bool is_group = H5Oget_info_by_name2(place_, name.data(), &object, H5O_INFO_BASIC, access_) >= 0 &&
                          object.type == H5O_TYPE_GROUP;
    if (is_group)
      groups_.emplace_back(name.data());
    else
      names.emplace_back(name.data());
  }
  return names;
}

bool Hdf5Columns::has(const std::string& name) const {
  const auto is_there = [&](const std::string& path) {
    return !path.empty() && Hdf5Id(H5Oopen(place_, path.c_str(), access_)).good();
  };
  return is_there(name) || is_there(without_index(name));
}

// As Hdf5Writer leaves it.
bool Hdf5Columns::has_exact_time() {
  if (H5Lexists(place_, kHdf5ExactTime, access_) <= 0) return false;
  const Hdf5Id exact(H5Dopen2(place_, kHdf5ExactTime, access_));
  return exact.good() &&
         hdf5_texts(exact, kHdf5Of, 1, kLongestHdf5Name) == std::vector<std::string>{kHdf5Time};
}

void Hdf5Columns::read_group(const Hdf5Wanted& wanted) {
  const std::vector<std::string> asked =
      asked_for(wanted.names, [&](const std::string& name) { return has(name); });
  std::vector<std::string> others = wanted.others ? datasets_of_group() : std::vector<std::string>();
  std::erase_if(others, [&](const std::string& name) {
    return std::find(asked.begin(), asked.end(), name) != asked.end();
  });
  const bool capture = asked.empty() && std::count(others.begin(), others.end(), kHdf5Time) > 0;
  if (has_exact_time()) std::erase(others, kHdf5ExactTime);
  keep_unpacked(std::clamp(kKeptOfAll / (asked.size() + others.size() + 1), kLeastKept, kMostKept));
  for (const std::string& name : asked) add_dataset(name, true);
  if (capture) {
    const auto time = std::find(others.begin(), others.end(), kHdf5Time);
    std::rotate(others.begin(), time, time + 1);  // as a CSV file begins
    for (const std::string& name : others) add_dataset(name, false);
  } else {
    add_what_is_a_column(others);
  }
  if (!groups_.empty() && !columns_.empty())
    header_.notices.push_back("not read: the groups " + list_of(groups_) + "; --group reads one");
}

// one: of a matrix a column is asked for, "name[1]".
void Hdf5Columns::add_dataset(const std::string& name, bool one) {
  const bool of_matrix = without_index(name) != name && H5Lexists(place_, name.c_str(), access_) <= 0;
  const bool exact = name == kHdf5Time && has_exact_time();
  const std::string dataset = exact ? kHdf5ExactTime : of_matrix ? without_index(name) : name;
  Hdf5Id found(H5Oopen(place_, dataset.c_str(), access_));
  if (!found.good()) {
    H5L_info_t link{};
    const bool there = H5Lget_info(place_, name.c_str(), &link, access_) >= 0;
    if (there && link.type == H5L_TYPE_EXTERNAL)
      refuse(in_quotes(name) + " is a link into another file, expected all in one");
    if (there) refuse(in_quotes(name) + " leads to nothing: " + hdf5_reason());
    refuse("no dataset " + in_quotes(name) + ", the group has " + list_of(datasets_of_group()));
  }
  if (H5Iget_type(found) != H5I_DATASET) refuse(in_quotes(name) + " is no dataset, expected one of numbers");
  const Hdf5Id type(H5Dget_type(found));
  demand_numbers(type, name);
  const std::vector<Part> parts = check(found, dataset);
  if (one && !of_matrix && parts.size() > 1)
    refuse(in_quotes(name) + " is a matrix, expected one of its columns: " + name + "[0] to " + name + "[" +
           std::to_string(parts.size() - 1) + "]");
  const std::size_t before = columns_.size(), value_bytes = H5Tget_size(type);
  const std::string unit = exact ? "s" : hdf5_unit(found);
  const Hdf5Value value = exact ? Hdf5Value::ns : value_of(type);
  found = {};  // how it is opened first says how much of it is kept
  const std::size_t every = kept_;
  keep_unpacked(std::max(every, chunk_of_last_));
  for (const Part& part : parts) {
    const std::string column = exact               ? name
                               : parts.size() == 1 ? dataset
                                                   : dataset + "[" + std::to_string(part.index) + "]";
    const bool is_asked = column == name || (parts.size() == 1 && name == dataset + "[0]");
    if (of_matrix && !is_asked) continue;
    if (!one && std::count(header_.names.begin(), header_.names.end(), column) > 0) continue;
    if (header_.names.size() == kInputLimits.hdf5_columns)
      refuse("more than " + std::to_string(kInputLimits.hdf5_columns) + " columns, expected at most that");
    stored_ += header_.rows * value_bytes;
    header_.names.push_back(one ? name : column);
    header_.units.push_back(unit);
    columns_.push_back(
        {Hdf5Id(H5Dopen2(place_, dataset.c_str(), access_)), Hdf5Id(H5Tcopy(in_memory(value))), value, part});
  }
  keep_unpacked(every);
  if (columns_.size() == before && one)
    refuse("no column " + in_quotes(name) + ", " + in_quotes(dataset) + " has " +
           std::to_string(parts.size()));
}

// As many rows as the columns before, and packed as can be read here.
std::vector<Hdf5Columns::Part> Hdf5Columns::check(hid_t dataset, const std::string& name) {
  chunk_of_last_ = 0;
  std::vector<Part> parts = take_rows(dataset, name);
  const Hdf5Id properties(H5Dget_create_plist(dataset));
  hdf5_demand(properties.good(), in_quotes(name) + " cannot be read");
  demand_readable(properties, name);
  take_chunk(dataset, properties, parts.front(), name);
  return parts;
}

// Whole chunks are read, so that each is unpacked once; of one that is larger than a block it is kept.
void Hdf5Columns::take_chunk(hid_t dataset, hid_t properties, const Part& part, const std::string& name) {
  std::array<hsize_t, 2> chunk{1, 1};
  if (H5Pget_layout(properties) == H5D_CHUNKED &&
      H5Pget_chunk(properties, part.rank, chunk.data()) != part.rank)
    chunk = {1, 1};
  const auto rows = static_cast<std::size_t>(
      std::clamp<hsize_t>(chunk[static_cast<std::size_t>(part.along)], 1, kMostBlock));
  block_rows_ = std::max(block_rows_, (kLeastBlock + rows - 1) / rows * rows);
  if (H5Pget_nfilters(properties) == 0) return;  // parts of it are read as they lie
  const Hdf5Id type(H5Dget_type(dataset));
  std::uint64_t bytes = 0;
  if (__builtin_mul_overflow(chunk[0], chunk[1], &bytes) ||
      __builtin_mul_overflow(bytes, H5Tget_size(type), &bytes) || bytes > kKeptOfAll - kept_of_all_)
    refuse(in_quotes(name) + " is packed in chunks of " + std::to_string(bytes >> 20U) +
           " MiB, expected at most " + std::to_string(kKeptOfAll >> 20U) +
           " MiB in all columns; 'h5repack -l CHUNK=65536' makes smaller ones");
  chunk_of_last_ = static_cast<std::size_t>(bytes);
  if (bytes > kept_) kept_of_all_ += chunk_of_last_;
  chunk_bytes_ = std::max(chunk_bytes_, chunk_of_last_);
}

std::vector<Hdf5Columns::Part> Hdf5Columns::take_rows(hid_t dataset, const std::string& name) {
  const Hdf5Id space(H5Dget_space(dataset));
  const int rank = H5Sget_simple_extent_ndims(space);
  hdf5_demand(rank >= 0, in_quotes(name) + " cannot be read");
  if (rank != 1 && rank != 2)
    refuse(in_quotes(name) + " has " + std::to_string(rank) +
           " dimensions, expected one, or two of a matrix");
  std::array<hsize_t, 2> size{1, 1};
  hdf5_demand(H5Sget_simple_extent_dims(space, size.data(), nullptr) == rank,
              in_quotes(name) + " cannot be read");
  const int along = rank == 1 || size[0] >= size[1] ? 0 : 1;  // more rows than columns
  const hsize_t rows = size[static_cast<std::size_t>(along)],
                columns = size[static_cast<std::size_t>(1 - along)];
  if (columns > kMostOfMatrix)
    refuse(in_quotes(name) + " is a matrix of " + std::to_string(size[0]) + " × " + std::to_string(size[1]) +
           ", expected at most " + std::to_string(kMostOfMatrix) + " columns");
  if (header_.names.empty()) header_.rows = rows;
  if (rows != header_.rows)
    refuse(in_quotes(name) + " has " + std::to_string(rows) + " rows, expected the " +
           std::to_string(header_.rows) + " of " + in_quotes(header_.names.front()));
  std::vector<Part> parts;
  for (hsize_t i = 0; i < columns; ++i) parts.push_back({rank, along, i});
  return parts;
}

// Takes of a group's datasets of numbers those as long as the columns so far, or as most of them.
void Hdf5Columns::add_what_is_a_column(const std::vector<std::string>& names) {
  std::map<hsize_t, std::vector<std::string>> by_rows;
  for (const std::string& name : names) {
    const Hdf5Id dataset(H5Dopen2(place_, name.c_str(), access_));
    const Hdf5Id type(dataset.good() ? H5Dget_type(dataset) : -1),
        space(dataset.good() ? H5Dget_space(dataset) : -1);
    std::array<hsize_t, 2> size{1, 1};
    const bool numbers =
        type.good() && (H5Tget_class(type) == H5T_INTEGER || H5Tget_class(type) == H5T_FLOAT);
    if (!numbers || !space.good() || H5Sget_simple_extent_ndims(space) > 2 ||
        H5Sget_simple_extent_dims(space, size.data(), nullptr) < 1)
      continue;
    if (std::min(size[0], size[1]) > kMostOfMatrix) continue;
    by_rows[std::max(size[0], size[1])].push_back(name);
  }
  std::pair<hsize_t, std::vector<std::string>> most;
  for (const auto& each : by_rows)
    if (columns_.empty() ? each.first > 1 && each.second.size() >= most.second.size()
                         : each.first == header_.rows)
      most = each;
  for (const std::string& name : names)
    if (std::find(most.second.begin(), most.second.end(), name) != most.second.end())
      add_dataset(name, false);
}

// All columns are of one dataset: a chunk of it is kept until each has been taken from it.
void Hdf5Columns::read_members(const Hdf5Wanted& wanted) {
  Hdf5Id type(H5Dget_type(place_));
  if (H5Tget_class(type) != H5T_COMPOUND)
    refuse(in_quotes(wanted.group) +
           " is a dataset, expected the group that holds it, or a table of records");
  if (check(place_, wanted.group).size() != 1)
    refuse(in_quotes(wanted.group) + " is a matrix of records, expected one column of them");
  if (chunk_bytes_ > kept_) {
    keep_unpacked(chunk_bytes_);
    place_ = {};  // what is open stays as it was opened
    place_ = Hdf5Id(H5Oopen(file_, wanted.group.c_str(), access_));
    hdf5_demand(place_.good(), in_quotes(wanted.group) + " cannot be read");
  }
  const std::vector<std::string> there = members_of(type);
  if (there.size() > kInputLimits.hdf5_columns)
    refuse("a table of " + std::to_string(there.size()) + " columns, expected at most " +
           std::to_string(kInputLimits.hdf5_columns));
  const auto add = [&](const std::string& name, bool asked) {
    const int member = H5Tget_member_index(type, name.c_str());
    if (member < 0) refuse("no column " + in_quotes(name) + ", the table has " + list_of(there));
    const Hdf5Id kind(H5Tget_member_type(type, static_cast<unsigned>(member)));
    const H5T_class_t is = H5Tget_class(kind);
    if (!asked && is != H5T_INTEGER && is != H5T_FLOAT) return;
    demand_numbers(kind, name);
    stored_ += header_.rows * H5Tget_size(kind);
    Hdf5Id dataset(H5Dopen2(place_, ".", access_));
    hdf5_demand(dataset.good(), in_quotes(wanted.group) + " cannot be read");
    header_.names.push_back(name);
    header_.units.emplace_back();
    const Hdf5Value value = value_of(kind);
    columns_.push_back({std::move(dataset), one_member(name, in_memory(value)), value, {}});
  };
  const std::vector<std::string> asked = asked_for(wanted.names, [&](const std::string& name) {
    return std::find(there.begin(), there.end(), name) != there.end();
  });
  for (const std::string& name : asked) add(name, true);
  if (!wanted.others) return;
  for (const std::string& name : there)
    if (std::find(asked.begin(), asked.end(), name) == asked.end()) add(name, false);
}

void Hdf5Columns::check_size(const Hdf5Wanted& wanted) const {
  if (columns_.empty())
    refuse("no dataset in the group " + in_quotes(wanted.group.empty() ? "/" : wanted.group) +
           (groups_.empty() ? "" : ", which has the groups " + list_of(groups_) + "; --group reads one"));
  if (header_.rows == 0) refuse("no rows in its datasets");
  const std::uint64_t most = std::max(kGrowthFree, wanted.file_bytes * kMostGrowth);
  if (header_.rows > most || stored_ > most)
    refuse("grows to more than " + std::to_string(most >> 20U) + " MiB, " + std::to_string(kMostGrowth) +
           " times its size, when unpacked, expected a recording");
}

void Hdf5Columns::read(std::size_t column, std::uint64_t first, std::span<std::uint64_t> to) {
  const Column& from = columns_[column];
  const auto along = static_cast<std::size_t>(from.part.along);
  std::array<hsize_t, 2> start{from.part.index, from.part.index}, count{1, 1};
  start[along] = first;
  count[along] = to.size();
  const hsize_t all = to.size();
  const Hdf5Id space(H5Dget_space(from.dataset)), memory(H5Screate_simple(1, &all, nullptr));
  hdf5_demand(
      space.good() && memory.good() &&
          H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) >= 0 &&
          H5Dread(from.dataset, from.in_memory, memory, space, H5P_DEFAULT, to.data()) >= 0,
      in_quotes(header_.names[column]) + " cannot be read from row " + std::to_string(first + 1) + " on");
}

}  // namespace ifog
