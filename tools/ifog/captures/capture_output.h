// SPDX-License-Identifier: Apache-2.0
// Writes a capture as columns, or as a recording of a device with its driver's encoder.
#pragma once

#include <string>

#include "tools/ifog/captures/capture_input.h"

namespace ifog::tools {

inline constexpr const char* kColumnEndings = ".csv, .csv.gz or .h5";

// Throws WrongUsage unless `path`, the value of `option`, is a name for columns. With `encoding` it may also
// be one for a device's recording. Call it before reading or writing.
void expect_capture_name(const std::string& option, const std::string& path, const CaptureInput* encoding);

// Writes columns: HDF5 if `to` ends so, otherwise CSV. `name` is the table's name in messages. Throws
// std::runtime_error with one line.
void write_columns(const LongTable& table, const std::string& name, const std::string& to);

// Writes a recording: `to` ends in .log for a CAN driver, in .bin or .kvh for a driver of bytes. Prints what
// the format cannot store on standard error. Throws as write_columns(), and WrongUsage if driver and ending
// do not match.
void write_recording(const LongTable& table, const std::string& name, const std::string& to,
                     const CaptureInput& encoding, const std::string& axis);

}  // namespace ifog::tools
