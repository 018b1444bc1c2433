// SPDX-License-Identifier: Apache-2.0
// What the HDF5 library counts for us (files, groups, datasets, types, …), given back at the end of a scope; what it
// says when it fails; and the texts that are attached to an object: the unit of a dataset, the comments of a capture.
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "drivers/ifog/quoted.h"

namespace ifog {

class Hdf5Id {
 public:
  Hdf5Id() = default;
  explicit Hdf5Id(hid_t id) : id_(id) {}
  Hdf5Id(Hdf5Id&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Hdf5Id& operator=(Hdf5Id&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Hdf5Id() {
    if (id_ >= 0) H5Idec_ref(id_);
  }

  [[nodiscard]] bool good() const { return id_ >= 0; }
  operator hid_t() const { return id_; }  // as the library's functions take it

 private:
  hid_t id_ = H5I_INVALID_HID;
};

// Where the library's story of a failure began, in one line.
inline std::string hdf5_reason() {
  std::string said;
  const auto first = [](unsigned, const H5E_error2_t* error, void* to) -> herr_t {
    auto& text = *static_cast<std::string*>(to);
    if (text.empty() && error->desc != nullptr) text = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, first, &said);
  return said.empty() ? "no reason given" : printable(said, 200);
}

// `what` with the library's reason where `good` is false. Throws std::runtime_error.
inline void hdf5_demand(bool good, const std::string& what) {
  if (!good) throw std::runtime_error(what + ": " + hdf5_reason());
}

// The library prints nothing from here on, in this thread.
inline void hdf5_silence() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

inline constexpr const char* kHdf5Units = "units";  // on a dataset, as the CF conventions call it
inline constexpr const char* kHdf5Time = "time_s";
// Beside time_s where doubles of that size lose digits: the same times as integers, which the attribute says.
inline constexpr const char* kHdf5ExactTime = "time_ns";
inline constexpr const char* kHdf5Of = "of";
inline constexpr const char* kHdf5Comments = "comments";  // on the group: the `#` lines, without the '#'

// The texts of an attribute, at most so many of at most so many bytes each; empty
// where there is none, or it is no text.
std::vector<std::string> hdf5_texts(hid_t object, const char* name, std::size_t most, std::size_t longest);
// The unit that a dataset says, "" for none.
std::string hdf5_unit(hid_t dataset);

// Throws std::runtime_error with one line.
void set_hdf5_texts(hid_t object, const char* name, const std::vector<std::string>& texts);
void set_hdf5_text(hid_t object, const char* name, const std::string& text);

}  // namespace ifog
