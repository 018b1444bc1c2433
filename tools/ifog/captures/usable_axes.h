// SPDX-License-Identifier: Apache-2.0
// What of a capture's rates cannot be used, in the same words for every command.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/ifog/captures/capture_view.h"
#include "tools/ifog/captures/table/long_table.h"

namespace ifog::tools {

// "rate_x is missing in 300 of 3000 rows, first at 2.5 s"; "" where none is missing.
std::string missing_in_words(const std::string& column, std::size_t missing, std::size_t rows,
                             double first_s);

// Tells that a column never has a value.
void tell_left_out(const std::string& name, const std::string& column, std::size_t rows);

// "one of 'x', 'y'"; where the only axis has no name, "none, the capture has one axis".
std::string expected_axes(const std::vector<std::string>& axes);

// The one refusal of a capture in which no axis has a value.
[[noreturn]] void refuse_without_rates(const std::string& name, std::size_t rows);

// The axes that never have a value, or repeat one while another axis does not: in one of several captures, as
// all are fitted together. Of the rates as the sensor sent them, as a correction that is alive would hide it.
// Prints on standard error, in these words, of each of them and what is missing of the others. Throws
// std::runtime_error with one line where no axis is left.
std::vector<std::string> unusable_axes(const std::vector<CaptureView>& captures,
                                       const std::vector<std::string>& names);
void leave_out(const std::vector<std::string>& axes, CaptureView& capture);

// Both in one. Of a table only those that never have a value: `denoise` gives what the daemon would.
void keep_usable_axes(std::vector<CaptureView>& captures, const std::vector<std::string>& names);
void keep_usable_axes(CaptureView& capture, const std::string& name);
void keep_usable_axes(LongTable& table, const std::string& name);

}  // namespace ifog::tools
