// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/hdf5/hdf5_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "drivers/capture/csv/text_cells.h"
#include "drivers/capture/times/row_sink.h"

namespace ifog {
namespace {

constexpr std::size_t kChunk = 65'536;  // in rows
constexpr unsigned kGzip = 6;
constexpr std::int64_t kMostSecondsInNs = 9'000'000'000;  // limit of int64 in ns
constexpr std::size_t kStep = 4U << 20U;                  // growth of the file in memory, bytes

// Unit of a column's name in user notation.
std::string unit_of(const std::string& name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kWritten = {{{"radps", "rad/s"},
                                                                                      {"rad2ps2", "rad2/s2"},
                                                                                      {"radps2", "rad/s2"},
                                                                                      {"mps", "m/s"},
                                                                                      {"mps2", "m/s2"},
                                                                                      {"degps", "deg/s"}}};
  const std::size_t line = name.rfind('_');
  if (line == std::string::npos) return "";
  std::string unit = name.substr(line + 1);
  for (const auto& [suffix, written] : kWritten)
    if (unit == suffix) return std::string(written);
  return unit;
}

std::string what_of(const std::string& column) { return "cannot write the dataset " + in_quotes(column); }

Hdf5Id file_in_memory() {
  constexpr unsigned kInOrder = H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED;
  const Hdf5Id access(H5Pcreate(H5P_FILE_ACCESS)), create(H5Pcreate(H5P_FILE_CREATE));
  const bool set = access.good() && create.good() && H5Pset_fapl_core(access, kStep, false) >= 0 &&
                   H5Pset_link_creation_order(create, kInOrder) >= 0 &&
                   // Ordered attributes may exceed 64 KiB.
                   H5Pset_attr_creation_order(create, kInOrder) >= 0 &&
                   H5Pset_obj_track_times(create, false) >= 0;
  Hdf5Id file(set ? H5Fcreate("capture", H5F_ACC_TRUNC, create, access) : H5I_INVALID_HID);
  hdf5_demand(file.good(), "cannot begin an HDF5 file");
  return file;
}

Hdf5Id packed(hsize_t chunk) {
  Hdf5Id properties(H5Pcreate(H5P_DATASET_CREATE));
  hdf5_demand(properties.good() && H5Pset_chunk(properties, 1, &chunk) >= 0 &&
                  H5Pset_shuffle(properties) >= 0 && H5Pset_deflate(properties, kGzip) >= 0 &&
                  H5Pset_obj_track_times(properties, false) >= 0,
              "cannot pack by gzip");
  return properties;
}

// The library's memory image, valid until the file is closed. Uses a format that any reader knows (by default
// the library uses the oldest sufficient one).
std::string_view image_of(hid_t file) {
  void* where = nullptr;  // owned by the driver
  const bool flushed = H5Fflush(file, H5F_SCOPE_GLOBAL) >= 0;
  const ssize_t size = flushed ? H5Fget_file_image(file, nullptr, 0) : -1;
  hdf5_demand(size > 0 && H5Fget_vfd_handle(file, H5P_DEFAULT, &where) >= 0 && where != nullptr,
              "cannot finish the HDF5 file");
  return {*static_cast<const char* const*>(where), static_cast<std::size_t>(size)};
}

template <typename Work>
auto with_name(const std::string& path, Work&& work) {
  try {
    return work();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

}  // namespace

Hdf5Writer::Hdf5Writer(const std::string& path, const std::string& comments,
                       const std::vector<std::string>& names)
    : path_(path), names_(names), out_(path), held_(names.size()) {
  hdf5_silence();
  with_name(path_, [&] {
    file_ = file_in_memory();
    if (!comments.empty()) set_hdf5_texts(file_, kHdf5Comments, lines_of(comments));
  });
}

Hdf5Id Hdf5Writer::begin_dataset(const std::string& name, hid_t type, hid_t properties) {
  const hsize_t none = 0, no_end = H5S_UNLIMITED;
  const Hdf5Id space(H5Screate_simple(1, &none, &no_end));
  if (name.find('/') != std::string::npos || name.empty() || name == ".")
    throw std::runtime_error(what_of(name) + ": no name for a dataset, expected one without '/'");
  Hdf5Id dataset(H5Dcreate2(file_, name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT));
  hdf5_demand(dataset.good(), what_of(name));
  if (const std::string unit = unit_of(name); !unit.empty()) set_hdf5_text(dataset, kHdf5Units, unit);
  return dataset;
}

void Hdf5Writer::begin_datasets(std::size_t chunk) {
  const Hdf5Id properties = packed(chunk);
  for (const std::string& name : names_) datasets_.push_back(begin_dataset(name, H5T_IEEE_F64LE, properties));
  if (!times_are_large_) return;
  exact_ = begin_dataset(kHdf5ExactTime, H5T_STD_I64LE, properties);
  set_hdf5_text(exact_, kHdf5Of, names_.front());
}

void Hdf5Writer::rows(std::span<const std::span<const double>> columns, const TimeOrigin& origin) {
  for (std::size_t c = 0; c < held_.size(); ++c)
    held_[c].insert(held_[c].end(), columns[c].begin(), columns[c].end());
  if (origin != TimeOrigin{}) take_large_times(columns.front(), origin);
  if (held_.front().size() >= kChunk)
    with_name(path_, [&] { flush(held_.front().size() / kChunk * kChunk); });
}

// They are the last buffered rows.
void Hdf5Writer::take_large_times(std::span<const double> since_s, const TimeOrigin& origin) {
  times_are_large_ = std::abs(origin.s) < kMostSecondsInNs && !std::ranges::count(names_, kHdf5ExactTime);
  std::vector<double>& time = held_.front();
  std::transform(since_s.begin(), since_s.end(), time.end() - static_cast<std::ptrdiff_t>(since_s.size()),
                 [&](double since) { return origin.in_s(since); });
  if (times_are_large_)
    for (const double since : since_s) held_ns_.push_back(origin.in_ns(since));
}

template <typename Value>
void Hdf5Writer::append(const Hdf5Id& dataset, const std::string& name, hid_t type, std::size_t rows,
                        std::vector<Value>& held) {
  const hsize_t first = written_, count = rows, all = first + count;
  const Hdf5Id memory(H5Screate_simple(1, &count, nullptr));
  const bool longer = H5Dset_extent(dataset, &all) >= 0;
  const Hdf5Id space(H5Dget_space(dataset));
  hdf5_demand(longer && space.good() &&
                  H5Sselect_hyperslab(space, H5S_SELECT_SET, &first, nullptr, &count, nullptr) >= 0 &&
                  H5Dwrite(dataset, type, memory, space, H5P_DEFAULT, held.data()) >= 0,
              what_of(name));
  held.erase(held.begin(), held.begin() + static_cast<std::ptrdiff_t>(rows));
}

// Writes the first buffered rows.
void Hdf5Writer::flush(std::size_t rows) {
  if (datasets_.empty()) begin_datasets(std::clamp<std::size_t>(rows, 1, kChunk));
  if (rows == 0) return;
  for (std::size_t c = 0; c < names_.size(); ++c)
    append(datasets_[c], names_[c], H5T_NATIVE_DOUBLE, rows, held_[c]);
  if (exact_.good()) append(exact_, kHdf5ExactTime, H5T_NATIVE_INT64, rows, held_ns_);
  written_ += rows;
}

void Hdf5Writer::finish() {
  const std::string_view image = with_name(path_, [&] {
    flush(held_.front().size());
    datasets_.clear();
    exact_ = {};
    return image_of(file_);
  });
  out_.write(image);
  file_ = {};
  out_.finish();
}

}  // namespace ifog
