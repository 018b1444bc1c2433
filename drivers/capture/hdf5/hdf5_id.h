// SPDX-License-Identifier: Apache-2.0
// What the HDF5 library counts for us (files, groups, datasets, types, …), given back at the end of a scope,
// and what it says when it fails.
#pragma once

#include <hdf5.h>

#include <stdexcept>
#include <string>
#include <utility>

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

}  // namespace ifog
