// SPDX-License-Identifier: Apache-2.0
// What there is to choose from in an HDF5 file, for messages: its groups and tables, the members of a record.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "drivers/capture/hdf5/hdf5_id.h"

namespace ifog {

// "text" of H5T_STRING: what stands where numbers are expected.
[[nodiscard]] const char* kind_of(H5T_class_t kind);
// "'a', 'b'", bounded; "none".
[[nodiscard]] std::string list_of(const std::vector<std::string>& names);
// What --group can name: the groups, with all of their path, and the tables of records. Throws std::runtime_error
// with one line.
[[nodiscard]] std::vector<std::string> places_of(hid_t file);
// The names of a record's members. Throws likewise.
[[nodiscard]] std::vector<std::string> members_of(hid_t type);

// "gyro" of the matrix's column "gyro[1]".
[[nodiscard]] std::string without_index(const std::string& name);
// The columns that are asked for; "sec+nsec" is two where no column is called so.
[[nodiscard]] std::vector<std::string> asked_for(const std::vector<std::string>& names,
                                                 const std::function<bool(const std::string&)>& has);

}  // namespace ifog
