// SPDX-License-Identifier: Apache-2.0
// RAII for HDF5 ids (files, groups, datasets, types, …); error texts of the library; and text attributes:
// units of a dataset, comments of a capture.
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
  operator hid_t() const { return id_; }  // for the library's functions

 private:
  hid_t id_ = H5I_INVALID_HID;
};

// The library's first error in one line.
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

// Throws std::runtime_error with `what` and the library's reason if `good` is false.
inline void hdf5_demand(bool good, const std::string& what) {
  if (!good) throw std::runtime_error(what + ": " + hdf5_reason());
}

// Disables the library's error output in this thread.
inline void hdf5_silence() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

inline constexpr const char* kHdf5Units = "units";  // on a dataset, as in the CF conventions
inline constexpr const char* kHdf5Time = "time_s";
// Next to time_s if doubles lose digits: the same times as integers, marked by an attribute.
inline constexpr const char* kHdf5ExactTime = "time_ns";
inline constexpr const char* kHdf5Of = "of";
inline constexpr const char* kHdf5Comments = "comments";  // on the group: the `#` lines, without the '#'

// Texts of an attribute, limited in number and length; empty if there is none or it is no text.
std::vector<std::string> hdf5_texts(hid_t object, const char* name, std::size_t most, std::size_t longest);
// Unit of a dataset, or "".
std::string hdf5_unit(hid_t dataset);

// Throws std::runtime_error with one line.
void set_hdf5_texts(hid_t object, const char* name, const std::vector<std::string>& texts);
void set_hdf5_text(hid_t object, const char* name, const std::string& text);

}  // namespace ifog
