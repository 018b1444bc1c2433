// SPDX-License-Identifier: Apache-2.0
// A capture as a file: its columns, or the recording that a device would have left, by its driver's encoder.
#pragma once

#include <string>

#include "tools/ifog/captures/capture_input.h"

namespace ifog::tools {

inline constexpr const char* kColumnEndings = ".csv, .csv.gz or .h5";

// That `path`, the value of `option`, takes columns, or, where there is an `encoding`, what a device would
// have sent: with a driver under any name that is no other format's. Throws WrongUsage (usage);
// before anything is read or written.
void expect_capture_name(const std::string& option, const std::string& path, const CaptureInput* encoding);

// As a capture in columns: HDF5 where `to` ends so, else CSV. `name` is what messages call the table. Throws
// std::runtime_error with one line.
void write_columns(const LongTable& table, const std::string& name, const std::string& to);

// `to` ends in .log for a CAN driver, in .bin or .kvh for one that speaks bytes. What the format has no place
// for is printed on standard error. Throws likewise, or WrongUsage (usage) when driver and ending do
// not fit.
void write_recording(const LongTable& table, const std::string& name, const std::string& to,
                     const CaptureInput& encoding, const std::string& axis);

}  // namespace ifog::tools
