// SPDX-License-Identifier: Apache-2.0
// Texts that are attached to an object of an HDF5 file: the unit of a dataset, the comments of a capture.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "drivers/capture/hdf5/hdf5_id.h"

namespace ifog {

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
