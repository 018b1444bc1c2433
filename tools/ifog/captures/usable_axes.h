// SPDX-License-Identifier: Apache-2.0
// Finds and reports unusable rates of captures, with the same words in every command.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "tools/ifog/captures/table/long_table.h"

namespace ifog::tools {

// "rate_x is missing in 300 of 3000 rows, first at 2.5 s"; "" if none is missing.
std::string missing_in_words(const std::string& column, std::size_t missing, std::size_t rows,
                             double first_s);

// Reports a column without values.
void tell_left_out(const std::string& name, const std::string& column, std::size_t rows);

// "one of 'x', 'y'"; "none, the capture has one axis" if the only axis has no name.
std::string expected_axes(const std::vector<std::string>& axes);

// Throws if no axis has a value.
[[noreturn]] void refuse_without_rates(const std::string& name, std::size_t rows);

// Axes without values, or that repeat one value while another axis does not, in any of the captures, because
// all are fitted together. Uses the rates as sent: a correction would hide a stuck axis. Prints each of them
// and missing values of the others on standard error. Throws std::runtime_error with one line if no axis is
// left.
std::vector<std::string> unusable_axes(const std::vector<CaptureView>& captures,
                                       const std::vector<std::string>& names);
// Drops these axes.
void leave_out(const std::vector<std::string>& axes, CaptureView& capture);

// Drops and reports the axes without values only: `denoise` behaves as the daemon.
void leave_out_dead_axes(LongTable& table, const std::string& name);

}  // namespace ifog::tools
